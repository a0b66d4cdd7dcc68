#include "respond/orbit.h"

#include "base/interrupt.h"
#include "integrate/integrate.h"
#include "simulate/numbers.h"
#include "simulate/simulate.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

enum { KEPT = ORBIT_LONGEST + 1 };

/* ---- the state that is carried ---- */

void carried_free(carried *c)
{
    dae_state_free(&c->state);
    c->exists = false;
}

void carried_copy(carried *to, const carried *from)
{
    carried_free(to);
    *to = *from;
    if (from->exists) {
        to->state = dae_state_create(&from->sizes, NULL);
        dae_state_copy(&from->sizes, &to->state, &from->state);
    }
}

void carried_keep(carried *c, archive *archive)
{
    enum { MOST = 1000000 };
    int sizes[] = {c->sizes.n, c->sizes.n_integers, c->sizes.n_reals};
    KEEP(archive, c->exists);
    KEEP_ARRAY(archive, sizes, 3);
    if (archive->is_reading) {
        archive->has_failed = archive->has_failed || sizes[0] > MOST || sizes[1] > MOST || sizes[2] > MOST ||
                              sizes[0] < 0 || sizes[1] < 0 || sizes[2] < 0;
        carried_free(c);
        if (archive->has_failed) {
            return;
        }
        c->sizes = (dae){.n = sizes[0], .n_integers = sizes[1], .n_reals = sizes[2]};
        c->state = dae_state_create(&c->sizes, NULL);
        c->exists = true;
    }
    KEEP(archive, c->state.t);
    KEEP_ARRAY(archive, c->state.y, c->sizes.n);
    KEEP_ARRAY(archive, c->state.yp, c->sizes.n);
    KEEP_ARRAY(archive, c->state.integers, c->sizes.n_integers);
    KEEP_ARRAY(archive, c->state.reals, c->sizes.n_reals);
    KEEP(archive, c->pitches);
    KEEP(archive, c->phase);
}

/* ---- the search ---- */

typedef enum { STOP_NONE, STOP_DONE, STOP_INTERRUPTED } stop_reason;

typedef struct {
    const prepared_case *prepared;
    const dae *dae;
    section section;
    double repeats; /**< distance below which states are the same */
    int most;
    const volatile sig_atomic_t *interrupt;
    dae_state seen[KEPT];   /**< on the section, taken back to the same place */
    double t_seen[KEPT];    /**< when [s] */
    double far[KEPT][KEPT]; /**< [section][orbit] distance to that many periods before; NAN: not known */
    int n_seen;             /**< since the section stands where it is */
    dae_state at;           /**< the last one as it was */
    numbers *numbers;       /**< of the window, once there is one */
    double t_stop;          /**< end of the window [s] */
    long enough;            /**< pitches after which it may end sooner; 0: it does not */
    orbit_result *result;
    stop_reason stop;
} search;

/** Whether the motion repeats after p periods: what is left of the way to that orbit, as a series that shrinks as the last two
 *  distances do, is no more than `repeats`; or all that is left is rounding. */
static bool has_come_to(const search *s, int k, int p)
{
    static const double rounding = 0.01;
    const double now = s->far[k % KEPT][p], before = s->far[(k - p) % KEPT][p], left = now * now / (before - now);
    const bool shrinks = now < before && now <= s->repeats && left <= s->repeats;
    return shrinks || (now <= rounding * s->repeats && before <= rounding * s->repeats);
}

/** The orbit that the motion is on; 0: none yet. A motion that winds itself to an orbit comes back to where it was after several
 *  periods sooner than after one: the shortest that is almost there is it, once it is there. */
static int find_period(const search *s, int k)
{
    static const double almost = 100;
    int found = 0;
    for (int p = 1; p <= ORBIT_LONGEST && 2 * p <= k && found == 0; p++) {
        found = has_come_to(s, k, p) ? p : 0;
    }
    for (int p = 1; p < found; p++) {
        found = s->far[k % KEPT][p] <= almost * s->repeats ? p : found;
    }
    return found > 0 && s->far[k % KEPT][found] <= s->repeats ? found : 0;
}

/** Find the numbers over whole pitches from now on. @param n  common periods */
static void open_window(search *s, int n, double pitch)
{
    bool taken[N_NUMBER_ROWS];
    for (int i = 0; i < N_NUMBER_ROWS; i++) {
        taken[i] = true;
    }
    const double place = s->dae->position(s->dae->self, s->section.position_of, &s->at);
    s->t_stop = s->at.t + (n * (double)s->section.period.pitches + 0.5) * pitch;
    const number_window window = {
        .from = s->at.t, .to = s->t_stop, .mesh = 0, .wheel = -1, .begins = place - floor(place)};
    s->numbers = numbers_create(s->prepared->model, &window, taken);
}

/** The shortest orbit after which the motion is where it was, or else that after which it is nearest. */
static int nearest_period(const search *s, int k)
{
    int nearest = 1;
    for (int p = 1; p <= ORBIT_LONGEST && p <= k; p++) {
        if (s->far[k % KEPT][p] <= s->repeats) {
            return p;
        }
    }
    for (int p = 2; p <= ORBIT_LONGEST && p <= k; p++) {
        nearest = s->far[k % KEPT][p] < s->far[k % KEPT][nearest] ? p : nearest;
    }
    return nearest;
}

/** The motion is on the section, at s->at. */
static void on_section(search *s)
{
    const int k = s->n_seen;
    dae_state *now = &s->seen[k % KEPT];
    dae_state_copy(s->dae, now, &s->at);
    model_take_back(s->prepared->model, &s->section.period, k, now);
    s->t_seen[k % KEPT] = s->at.t;
    for (int p = 1; p <= ORBIT_LONGEST; p++) {
        s->far[k % KEPT][p] = p <= k ? model_distance(s->prepared->model, now, &s->seen[(k - p) % KEPT]) : NAN;
    }
    s->n_seen++;
    s->result->periods++;
    if (s->numbers != NULL) {
        return;
    }
    const double length = s->section.period.pitches;
    const bool is_over = s->result->periods + ORBIT_WINDOW + 2 >= s->most && k > 0;
    int period = find_period(s, k);
    if (period > 0 || is_over) {
        const int near = period > 0 ? period : nearest_period(s, k);
        s->result->distance = s->far[k % KEPT][near];
        period = s->result->distance <= s->repeats || period > 0 ? near : 0; /* one that still settles, slowly */
        s->result->period = period;
        s->result->time = period > 0 ? s->at.t - s->t_seen[(k - near) % KEPT] : 0;
        open_window(s, period > 0 ? period : ORBIT_WINDOW, (s->at.t - s->t_seen[(k - near) % KEPT]) / (near * length));
    }
}

static void on_watch(void *self, const integrate_step *step)
{
    search *s = self;
    if (!(step->t_to > step->t_from) || s->stop != STOP_NONE) {
        return;
    }
    if (s->numbers != NULL) {
        numbers_watch(s->numbers, step);
    }
    while (section_reached(&s->section, step, &s->at)) {
        section_passed(&s->section);
        const bool had_window = s->numbers != NULL;
        on_section(s);
        if (s->numbers != NULL && !had_window) {
            numbers_watch(s->numbers, step);
        }
    }
    if (s->numbers != NULL &&
        (step->t_to >= s->t_stop || (s->enough > 0 && numbers_span(s->numbers).periods >= s->enough))) {
        s->stop = STOP_DONE;
    }
}

static int on_event(void *self, const event_record *record)
{
    search *s = self;
    section_event(&s->section, record);
    if (s->numbers != NULL) {
        numbers_event(s->numbers, record);
    } else if (section_moves(&s->section)) {
        s->n_seen = 0;
    }
    return 0;
}

static int on_step(void *self, double t)
{
    search *s = self;
    (void)t;
    s->stop = *s->interrupt != 0 ? STOP_INTERRUPTED : s->stop;
    return s->stop != STOP_NONE;
}

/** How fast a motion by angle passes pitches [1/s]. */
static double pitch_rate(const search *s, const dae_state *state)
{
    static const double instant = 1e-6;
    dae_state later = {.integers = state->integers, .y = xcalloc((size_t)s->dae->n, sizeof(double))};
    for (int i = 0; i < s->dae->n; i++) {
        later.y[i] = state->y[i] + instant * state->yp[i];
    }
    const double rate = (s->dae->position(s->dae->self, s->section.position_of, &later) -
                         s->dae->position(s->dae->self, s->section.position_of, state)) /
                        instant;
    free(later.y);
    return rate;
}

/** @return the last time to which the motion is followed [s]; NAN if nothing turns */
static double time_limit(const search *s, const dae_state *state)
{
    static const double slow = 20; /* a motion that goes slower than this many times what it began with stands still */
    const double pitches = (s->most + 2.0) * s->section.period.pitches;
    if (s->section.period.by_time) {
        return state->t + s->section.period.time * (s->most + 2.0);
    }
    const double rate = pitch_rate(s, state);
    return rate > 0 ? state->t + slow * pitches / rate : NAN;
}

/** Put the last state on the section back into the first period. */
static void carry(const search *s, carried *state)
{
    const model_period *period = &s->section.period;
    const int k = s->n_seen - 1;
    const dae_state *last = &s->seen[k % KEPT];
    dae_state *to = &state->state;
    dae_state_copy(s->dae, to, last);
    to->t = period->by_time ? s->at.t - period->time * k : 0;
    const int more = (int)floor(section_place(&s->section, to) / period->pitches);
    model_take_back(s->prepared->model, period, more, to);
    to->t -= more * (period->by_time ? period->time : 0);
    state->pitches = period->by_time ? section_place(&s->section, to) : 0;
    state->phase = s->section.phase;
}

static int usual_most(const model_period *period)
{
    const int few = ORBIT_USUAL_PERIODS / period->pitches;
    return few > ORBIT_LEAST_PERIODS ? few : ORBIT_LEAST_PERIODS;
}

orbit_end orbit_find(const prepared_case *prepared, const model_period *period, carried *state, int most,
                     const volatile sig_atomic_t *interrupt, orbit_result *result, double *values,
                     char message[DAE_MESSAGE_LENGTH])
{
    POOLED memory_pool pool = {NULL};
    search *s = pool_calloc(&pool, 1, sizeof *s);
    integrate_options options = simulate_options(prepared);
    static const double smallest = 1e-6, times = 1000; /* of the tolerance, in the same units */
    *result = (orbit_result){.pitches = period->pitches, .distance = NAN};
    s->prepared = prepared;
    s->dae = &model_about(prepared->model)->dae;
    s->repeats = fmax(smallest, times * options.tolerance);
    s->interrupt = interrupt != NULL ? interrupt : &interrupt_signal;
    s->most = most > 0 ? most : usual_most(period);
    s->result = result;
    s->at = dae_state_create(s->dae, &pool);
    for (int i = 0; i < KEPT; i++) {
        s->seen[i] = dae_state_create(s->dae, &pool);
    }
    dae_state now = dae_state_create(s->dae, &pool);
    dae_state_copy(s->dae, &now, &state->state);
    section_begin(&s->section, &pool, prepared->model, period, state->phase, &now);
    options.t_end = time_limit(s, &now);
    options.output_interval = options.t_end - now.t;
    options.per_unit = 0;
    const integrate_observer observer = {.self = s, .event = on_event, .step = on_step, .watch = on_watch};
    integrate_counts counts;
    message[0] = '\0';
    if (isnan(options.t_end)) {
        (void)snprintf(
            message, DAE_MESSAGE_LENGTH,
            "nothing turns the first mesh in its nominal sense where the motion begins; start with speeds, or "
            "from a steady state");
        return ORBIT_FAILED;
    }
    const integrate_code code = integrate(s->dae, &options, &observer, &now, &counts, message);
    orbit_end end = s->stop == STOP_DONE ? ORBIT_FOUND : s->stop == STOP_INTERRUPTED ? ORBIT_INTERRUPTED : ORBIT_FAILED;
    if (end == ORBIT_FAILED && code == INTEGRATE_DONE) {
        (void)snprintf(message, DAE_MESSAGE_LENGTH,
                       "the first mesh passed %.4g pitches in %.4g s: it all but stands still",
                       result->periods * (double)period->pitches, now.t - state->state.t);
    }
    if (end == ORBIT_FOUND) {
        numbers_conclude(s->numbers, values);
        carry(s, state);
    }
    numbers_delete(&s->numbers);
    return end;
}

/** Whether a run came back to where it began, after so many common periods; where it did is taken back to there.
 *  @param near  in units of the states; what is grazed may throw it off its orbit */
static bool has_come_back(search *s, const dae_state *start, int periods, double near)
{
    enum { OMEGA = 1 }; /* behind the angle, which grows */
    if (s->n_seen < periods) {
        return false;
    }
    dae_state *last = &s->seen[(periods - 1) % KEPT];
    model_take_back(s->prepared->model, &s->section.period, 1, last);
    for (int i = OMEGA; i < s->dae->n; i++) {
        if (!(fabs(last->y[i] - start->y[i]) <= near * s->dae->scale[i])) {
            return false;
        }
    }
    return true;
}

orbit_end orbit_tell(const prepared_case *prepared, const model_period *period, const dae_state *state, int periods,
                     double time, bool is_stable, const volatile sig_atomic_t *interrupt, dae_state *round,
                     double *values, char message[DAE_MESSAGE_LENGTH])
{
    /* tolerance: numbers and returns are right to 1e-8; what is unstable leaves its orbit slowly enough */
    const double tight = is_stable ? 1e-9 : 1e-11;
    POOLED memory_pool pool = {NULL};
    search *s = pool_calloc(&pool, 1, sizeof *s);
    integrate_options options = simulate_options(prepared);
    orbit_result result = {.period = periods};
    const double pitch = time / period->pitches;
    s->interrupt = interrupt;
    s->prepared = prepared;
    s->dae = &model_about(prepared->model)->dae;
    s->result = &result;
    s->at = dae_state_create(s->dae, &pool);
    for (int i = 0; i < KEPT; i++) {
        s->seen[i] = dae_state_create(s->dae, &pool);
    }
    dae_state now = dae_state_create(s->dae, &pool);
    if (!model_take_over(prepared->model, s->dae, state, state->t, &now, message)) {
        return ORBIT_FAILED;
    }
    dae_state_copy(s->dae, &s->at, &now);
    section_begin(&s->section, &pool, prepared->model, period, SECTION_USUAL_PHASE, &now);
    const double place = section_place(&s->section, &now);
    section_begin(&s->section, &pool, prepared->model, period, place - period->pitches * floor(place / period->pitches),
                  &now);
    dae_state began = dae_state_create(s->dae, &pool);
    dae_state_copy(s->dae, &began, &now);
    open_window(s, periods, pitch);
    s->enough = (long)periods * period->pitches;
    options.tolerance = fmin(options.tolerance, tight);
    options.t_end = s->t_stop + pitch;
    options.output_interval = options.t_end - now.t;
    options.per_unit = 0;
    const integrate_observer observer = {.self = s, .event = on_event, .step = on_step, .watch = on_watch};
    integrate_counts counts;
    (void)integrate(s->dae, &options, &observer, &now, &counts, message);
    orbit_end end = s->stop == STOP_DONE ? ORBIT_FOUND : s->stop == STOP_INTERRUPTED ? ORBIT_INTERRUPTED : ORBIT_FAILED;
    if (end == ORBIT_FOUND && !has_come_back(s, &began, periods, round != NULL ? INFINITY : 1e-4)) {
        (void)snprintf(message, DAE_MESSAGE_LENGTH, "a run leaves the orbit: its numbers are left out");
        end = ORBIT_FAILED;
    }
    if (end == ORBIT_FOUND) {
        numbers_conclude(s->numbers, values);
    }
    if (end == ORBIT_FOUND && round != NULL) {
        const dae_state *last = &s->seen[(periods - 1) % KEPT];
        round->t = last->t;
        memcpy(round->y, last->y, (size_t)s->dae->n * sizeof *round->y);
        memcpy(round->integers, last->integers, (size_t)s->dae->n_integers * sizeof *round->integers);
        memcpy(round->reals, last->reals, (size_t)s->dae->n_reals * sizeof *round->reals);
    }
    numbers_delete(&s->numbers);
    return end;
}
