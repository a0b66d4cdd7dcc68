#include "integrate/position_grid.h"

#include <float.h>
#include <math.h>
#include <string.h>

enum { DEGREE = DAE_DENSE_DEGREE, N = DEGREE + 1, MOST_HALVINGS = 48, MOST_TRIALS = 100 };

static const double on_grid = 1e-9;             /* in steps of the grid: a position this close to the grid is on it */
static const double many_reaches = 4;           /* relative to the distance covered by a step, or extrapolated with the
                                                 * previous speed */
static const double rounding = 8 * DBL_EPSILON; /* of a position */

/** Search of a step. */
typedef struct {
    const position_grid *grid;
    const integrate_step *step;
    dae_state *scratch;
} search;

/** A position at a time, in steps of the grid. */
typedef struct {
    double t, u;
} moment;

/** Snap a position to the grid if it is on it within rounding. */
static double settle(double u)
{
    const double line = round(u);
    return fabs(u - line) <= fmax(on_grid, rounding * fabs(u)) ? line : u;
}

static double grid_position(const dae *model, int per_unit, int position_of, const dae_state *state)
{
    return per_unit * model->position(model->self, position_of, state);
}

output_mark output_grid_mark(const dae *model, const integrate_options *options, const dae_state *state)
{
    const double u = settle(grid_position(model, options->per_unit, options->position_of, state));
    return (output_mark){u / options->per_unit, fabs(u - round(u)) > 0 ? OUTPUT_OFF_GRID : OUTPUT_FORWARDS};
}

/** Position at a time in the step; NaN if not available. */
static double position_at(const search *s, double t)
{
    const position_grid *grid = s->grid;
    if (t >= s->step->t_to) {
        return grid_position(grid->model, grid->per_unit, grid->position_of, s->step->state);
    }
    s->scratch->t = t;
    return s->step->interpolate(s->step->with, t, s->scratch->y)
               ? grid_position(grid->model, grid->per_unit, grid->position_of, s->scratch)
               : NAN;
}

/* ---- polynomials in Bernstein's form ---- */

/** Convert values at N equidistant points, including the ends: Newton's form, powers, then Bernstein's form. */
static void bernstein_of_values(double c[N])
{
    for (int k = 1; k < N; k++) {
        for (int i = DEGREE; i >= k; i--) {
            c[i] = (c[i] - c[i - 1]) / k;
        }
    }
    for (int k = DEGREE - 1; k >= 0; k--) {
        for (int i = k; i < DEGREE; i++) {
            c[i] -= k * c[i + 1];
        }
    }
    double factor = 1; /* DEGREE^i / (DEGREE over i): powers of a variable from 0 to 1 */
    for (int i = 1; i < N; i++) {
        factor *= (double)DEGREE * i / (DEGREE - i + 1);
        c[i] *= factor;
    }
    for (int k = 1; k < N; k++) {
        for (int i = DEGREE; i >= k; i--) {
            c[i] += c[i - 1];
        }
    }
}

/** Split at the middle of the interval: de Casteljau. */
static void halve(const double c[N], double left[N], double right[N])
{
    memcpy(right, c, N * sizeof *c);
    for (int k = 0; k < N; k++) {
        left[k] = right[0];
        for (int i = 0; i < DEGREE - k; i++) {
            right[i] = 0.5 * (right[i] + right[i + 1]);
        }
    }
}

typedef struct {
    double low, high;
    bool turns;
} bounds;

static bounds bounds_of(const double c[N])
{
    bounds found = {c[0], c[0], false};
    int rises = 0, falls = 0;
    for (int i = 1; i < N; i++) {
        rises += c[i] > c[i - 1];
        falls += c[i] < c[i - 1];
        found.low = fmin(found.low, c[i]);
        found.high = fmax(found.high, c[i]);
    }
    found.turns = rises > 0 && falls > 0;
    return found;
}

/* ---- crossing of grid lines ---- */

/** Time at which a monotonic motion reaches a line between two moments: false position, with bisection where that is
 *  slow. */
static double meet(const search *s, moment a, moment b, double line)
{
    const double rising = b.u > a.u ? 1 : -1, enough = rounding * fmax(1, fabs(line));
    double left = a.t, right = b.t, before = rising * (a.u - line), behind = rising * (b.u - line);
    double best = right, least = fabs(position_at(s, right) - line);
    int side = 0; /* side of the line of the last iterate */
    for (int i = 0; i < MOST_TRIALS && least > enough; i++) {
        const double share = i % 4 == 3 ? 0.5 : before / (before - behind);
        const double t = left + share * (right - left);
        if (!(t > left && t < right)) {
            break;
        }
        const double off = rising * (position_at(s, t) - line);
        if (fabs(off) < least) {
            best = t;
            least = fabs(off);
        }
        if (off < 0) {
            left = t;
            before = off;
            behind *= side < 0 ? 0.5 : 1;
            side = -1;
        } else {
            right = t;
            behind = off;
            before *= side > 0 ? 0.5 : 1;
            side = 1;
        }
    }
    return fmax(best, nextafter(a.t, INFINITY));
}

/** The first line reached by a monotonic motion. */
static bool pass(const search *s, moment a, moment b, double *t, output_mark *mark)
{
    const bool rises = b.u > a.u;
    const double line = rises ? floor(a.u) + 1 : ceil(a.u) - 1, t_end = s->grid->t_end;
    if (!(rises ? b.u >= line : b.u <= line) || !(b.u < a.u || rises)) {
        return false;
    }
    if (b.t >= t_end && !(rises ? b.u > line : b.u < line)) {
        return false; /* the end itself */
    }
    *t = meet(s, a, b, line);
    *mark = (output_mark){line / s->grid->per_unit, rises ? OUTPUT_FORWARDS : OUTPUT_BACKWARDS};
    return *t < t_end;
}

/** The first line crossed between two moments. */
static bool find(const search *s, moment a, moment b, const double c[N], int halvings, double *t, output_mark *mark)
{
    const bounds bounds = bounds_of(c);
    const double high = fmax(bounds.high, fmax(a.u, b.u)), low = fmin(bounds.low, fmin(a.u, b.u));
    if (!(floor(high + on_grid) >= ceil(low - on_grid))) {
        return false;
    }
    if (!bounds.turns || high - low <= on_grid || halvings == 0) {
        return pass(s, a, b, t, mark);
    }
    double left[N], right[N];
    moment middle = {a.t + 0.5 * (b.t - a.t), 0};
    middle.u = settle(position_at(s, middle.t));
    halve(c, left, right);
    return find(s, a, middle, left, halvings - 1, t, mark) || find(s, middle, b, right, halvings - 1, t, mark);
}

void position_grid_begin(position_grid *grid, const dae *model, const integrate_options *options,
                         const dae_state *start)
{
    *grid = (position_grid){.model = model,
                            .per_unit = options->per_unit,
                            .position_of = options->position_of,
                            .t_end = options->t_end,
                            .t = start->t};
    grid->position = settle(grid_position(model, options->per_unit, options->position_of, start));
}

/** Whether no grid line is near a short step, to `end`, that continues the previous one. */
static bool is_far(const position_grid *grid, moment from, double end, double span)
{
    const double reach = many_reaches * fmax(fabs(end - from.u), grid->speed * span);
    return floor(fmax(from.u, end) + reach + on_grid) < ceil(fmin(from.u, end) - reach - on_grid);
}

/** Record that no other line was crossed until t. */
static void leave(position_grid *grid, double t, double position, double span)
{
    grid->speed = fabs(position - grid->position) / span;
    grid->t = t;
    grid->position = settle(position);
}

bool position_grid_next(position_grid *grid, const integrate_step *step, dae_state *scratch, double *t,
                        output_mark *mark)
{
    const search s = {grid, step, scratch};
    const moment from = {fmax(grid->t, step->t_from), grid->position};
    if (!(step->t_to > from.t)) {
        return false;
    }
    const double end = position_at(&s, step->t_to), span = step->t_to - from.t;
    if (step->continues && is_far(grid, from, end, span)) {
        leave(grid, step->t_to, end, span);
        return false;
    }
    double c[N];
    for (int i = 0; i < DEGREE; i++) {
        c[i] = position_at(&s, from.t + i * span / DEGREE);
    }
    c[DEGREE] = end;
    const moment to = {step->t_to, settle(c[DEGREE])};
    bernstein_of_values(c);
    if (find(&s, from, to, c, MOST_HALVINGS, t, mark)) {
        return true;
    }
    leave(grid, to.t, to.u, span);
    return false;
}

void position_grid_advance(position_grid *grid, double t, const output_mark *mark)
{
    grid->t = t;
    grid->position = round(mark->position * grid->per_unit);
}

void position_grid_serialize(position_grid *grid, archive *archive)
{
    SERIALIZE(archive, grid->t);
    SERIALIZE(archive, grid->position);
    SERIALIZE(archive, grid->speed);
}
