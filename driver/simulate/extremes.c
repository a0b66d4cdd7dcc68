#include "simulate/extremes.h"

#include "base/memory.h"
#include "base/peak.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

/** Channels at the ends of the last two steps, for an integrator that tells no more of them. */
typedef struct {
    int n_known;                   /**< ends since nothing was continued */
    double t, t_older;             /**< of the last two */
    double *values, *older, *ends; /**< [n] there, and at the end of the present step */
} channel_past;

struct extremes {
    const dae *dae;
    int n;                        /**< channels */
    int n_padded;                 /**< the same with idle ones behind them, so that loops over all go in vectors */
    double from, to;              /**< window */
    bool has_begun;               /**< a state in the window was seen */
    double *high, *low;           /**< [n] so far; +INFINITY and -INFINITY if nobody asks */
    double *high_time, *low_time; /**< [n] */
    double *values;               /**< [n] at the state last asked */
    double t_values;              /**< its time, if it is in the present step; else NAN */
    double *middle;               /**< [n] in the middle of a step */
    double *y;                    /**< [states] */
    channel_past past;
};

/* ---- what is kept ---- */

static int channel_of(int index, int mesh)
{
    return model_n_watched() * mesh + model_extremes()[index].watched;
}

/** Vectors of 8 take them all. */
static int padded(int n)
{
    return (n + 7) / 8 * 8;
}

static double *array(int n)
{
    return xcalloc((size_t)padded(n), sizeof(double));
}

extremes *extremes_create(const model *model, int n_meshes, double from, double to)
{
    const dae *dae = model_dae(model);
    const int n = dae->n_watched;
    extremes *extremes = xcalloc(1, sizeof *extremes);
    *extremes = (struct extremes){.dae = dae,
                                  .n = n,
                                  .n_padded = padded(n),
                                  .from = from,
                                  .to = to,
                                  .high = array(n),
                                  .low = array(n),
                                  .high_time = array(n),
                                  .low_time = array(n),
                                  .values = array(n),
                                  .middle = array(n),
                                  .y = array(dae->n),
                                  .past = {.values = array(n), .older = array(n), .ends = array(n)}};
    for (int i = 0; i < extremes->n_padded; i++) {
        extremes->high[i] = INFINITY;
        extremes->low[i] = -INFINITY;
    }
    for (int k = 0; k < model_n_extremes(); k++) {
        for (int mesh = 0; mesh < n_meshes; mesh++) {
            const int channel = channel_of(k, mesh);
            if (model_extremes()[k].is_largest) {
                extremes->high[channel] = -INFINITY;
            } else {
                extremes->low[channel] = INFINITY;
            }
        }
    }
    return extremes;
}

void extremes_delete(extremes **pointer)
{
    extremes *extremes = *pointer;
    *pointer = NULL;
    if (extremes == NULL) {
        return;
    }
    free(extremes->high);
    free(extremes->low);
    free(extremes->high_time);
    free(extremes->low_time);
    free(extremes->values);
    free(extremes->middle);
    free(extremes->y);
    free(extremes->past.values);
    free(extremes->past.older);
    free(extremes->past.ends);
    free(extremes);
}

double extremes_value(const extremes *extremes, int index, int mesh)
{
    const double *of = model_extremes()[index].is_largest ? extremes->high : extremes->low;
    return extremes->has_begun ? of[channel_of(index, mesh)] : NAN;
}

double extremes_time(const extremes *extremes, int index, int mesh)
{
    const double *of = model_extremes()[index].is_largest ? extremes->high_time : extremes->low_time;
    return extremes->has_begun ? of[channel_of(index, mesh)] : NAN;
}

int extremes_find(const char *output, bool is_largest)
{
    for (int k = 0; k < model_n_extremes(); k++) {
        if (strcmp(model_extremes()[k].output, output) == 0 && model_extremes()[k].is_largest == is_largest) {
            return k;
        }
    }
    return -1;
}

/* ---- states ---- */

/** Whether any channel passes its limits. A loop without a branch, since most often none does. */
static bool any_passes(int n, const double *restrict values, const double *restrict high, const double *restrict low)
{
    int64_t any = 0;
    for (int i = 0; i < n; i++) {
        any |= (int64_t)(values[i] > high[i]) | (int64_t)(values[i] < low[i]);
    }
    return any != 0;
}

/** The channels at a time in the window. */
static void take(extremes *extremes, double t)
{
    const double *values = extremes->values;
    extremes->has_begun = true;
    if (!any_passes(extremes->n_padded, values, extremes->high, extremes->low)) {
        return;
    }
    for (int i = 0; i < extremes->n; i++) {
        if (values[i] > extremes->high[i]) {
            extremes->high[i] = values[i];
            extremes->high_time[i] = t;
        }
        if (values[i] < extremes->low[i]) {
            extremes->low[i] = values[i];
            extremes->low_time[i] = t;
        }
    }
}

/** The channels at a state. */
static bool know(extremes *extremes, const dae_state *state, const double *known)
{
    char message[DAE_MESSAGE_LENGTH];
    const dae *dae = extremes->dae;
    if (known != NULL) {
        memcpy(extremes->values, known, (size_t)extremes->n * sizeof(double));
        return true;
    }
    return dae->watched(dae->self, state, extremes->values, message) == DAE_OK;
}

static bool know_at(extremes *extremes, const integrate_step *step, double t)
{
    const double place = t < step->t_to ? t : step->t_to;             /* fmin is a call */
    if (extremes->t_values >= place && extremes->t_values <= place) { /* as where several channels rise */
        return true;
    }
    extremes->t_values = NAN;
    bool good;
    if (place < step->t_to) {
        dae_state state = *step->state;
        state.t = t;
        state.y = extremes->y;
        good = step->interpolate(step->with, t, extremes->y) && know(extremes, &state, NULL);
    } else {
        good = know(extremes, step->state, step->watched);
    }
    if (good) {
        extremes->t_values = place;
    }
    return good;
}

static bool see_at(extremes *extremes, const integrate_step *step, double t)
{
    const bool good = know_at(extremes, step, t);
    if (good) {
        take(extremes, extremes->t_values);
    }
    return good;
}

/** A channel in a step, looked at in one sense. */
typedef struct {
    extremes *extremes;
    const integrate_step *step;
    int channel, sense;
} view;

/** The larger, the nearer to an extreme. */
static double height(void *with, double t)
{
    const view *view = with;
    return see_at(view->extremes, view->step, t) ? view->sense * view->extremes->values[view->channel] : NAN;
}

static double wanted(const extremes *extremes, int channel, int sense)
{
    return sense > 0 ? extremes->high[channel] : -extremes->low[channel];
}

static double within(double t, double from, double to)
{
    return fmin(fmax(t, from), to);
}

/* ---- steps of an integrator that knows candidates ---- */

static void take_candidates(extremes *extremes, const integrate_step *step, double from, double to)
{
    static const double first_width = 0.02; /* of the bracket: a candidate is near the maximum */
    const int n = step->look(step->with, extremes->high, extremes->low);
    for (int i = 0; i < n; i++) {
        dae_candidate one;
        step->candidate(step->with, i, &one);
        if (one.left > to || one.right < from) {
            continue;
        }
        view view = {extremes, step, one.channel, one.sense};
        const peak_bracket bracket = {.left = within(one.left, from, to),
                                      .right = within(one.right, from, to),
                                      .start = within(one.t, from, to),
                                      .width = first_width * (one.right - one.left),
                                      .expected = one.sense * one.value,
                                      .wanted = wanted(extremes, one.channel, one.sense)};
        peak_climb(height, &view, &bracket);
    }
}

/* ---- steps of one that does not ---- */

/** How far a channel may go beyond both ends of a step, judged by its moves in it and in the step before. */
static double reach_of(double older, double a, double b, double ratio)
{
    return 0.5 * (fabs(b - a) + fabs((a - older) * ratio));
}

/** Whether a channel may have exceeded its extremes inside the step. */
static bool may_exceed(const extremes *extremes, int i, double ratio)
{
    const channel_past *past = &extremes->past;
    const double a = past->values[i], b = past->ends[i], reach = reach_of(past->older[i], a, b, ratio);
    return (a > b ? a : b) + reach > extremes->high[i] || (a < b ? a : b) - reach < extremes->low[i];
}

/** Whether any channel may: the same without a branch. */
static bool any_may_exceed(int n, const channel_past *past, double ratio, const double *restrict high,
                           const double *restrict low)
{
    const double *restrict older = past->older, *restrict from = past->values, *restrict to = past->ends;
    int64_t any = 0;
    for (int i = 0; i < n; i++) {
        const double a = from[i], b = to[i], reach = reach_of(older[i], a, b, ratio);
        const double top = a > b ? a : b, bottom = a < b ? a : b;
        any |= (int64_t)(top + reach > high[i]) | (int64_t)(bottom - reach < low[i]);
    }
    return any != 0;
}

/** Of such a channel: whether its slope, in the sense of the search, falls through zero inside the step. */
static bool may_turn(const extremes *extremes, int i, int sense, double ratio)
{
    static const double margin = 0.5; /* of the change of the slope: the third derivative is not known */
    const channel_past *past = &extremes->past;
    if (past->n_known < 2) {
        return true;
    }
    const double now = sense * (past->ends[i] - past->values[i]);
    const double before = sense * (past->values[i] - past->older[i]) * ratio;
    const double bend = (now - before) * 2 * ratio / (1 + ratio); /* by which the slope changes in the step */
    const double doubt = margin * fabs(bend);
    return now - 0.5 * bend + doubt >= 0 && now + 0.5 * bend - doubt <= 0;
}

/** The same judged by both ends and the middle of the part of the step from t[0] to t[2], and if so the place is sought. */
static void take_middle(extremes *extremes, const integrate_step *step, const double t[3], int i, int sense)
{
    static const double margin = 0.1, first_width = 0.05;
    const channel_past *past = &extremes->past;
    const double f[3] = {sense * past->values[i], sense * extremes->middle[i], sense * past->ends[i]};
    const double limit = wanted(extremes, i, sense);
    const double bend = fabs(f[0] - 2 * f[1] + f[2]), top = fmax(fmax(f[0], f[1]), f[2]);
    const double doubt = margin * (bend + fabs(f[2] - f[0]));
    const double slope_from = -3 * f[0] + 4 * f[1] - f[2], slope_to = f[0] - 4 * f[1] + 3 * f[2];
    if (top + bend <= limit || slope_from + doubt < 0 || slope_to - doubt > 0) {
        return;
    }
    const double place = peak_of_parabola(t, f);
    view view = {extremes, step, i, sense};
    const peak_bracket bracket = {.left = t[0],
                                  .right = t[2],
                                  .start = isnan(place) ? t[1] : within(place, t[0], t[2]),
                                  .width = first_width * (t[2] - t[0]),
                                  .expected = NAN,
                                  .wanted = limit};
    peak_climb(height, &view, &bracket);
}

/** Look between two states that have been seen: past.t and `to`. */
static void take_ends(extremes *extremes, const integrate_step *step, double to)
{
    channel_past *past = &extremes->past;
    const double ratio = past->n_known > 1 ? (to - past->t) / (past->t - past->t_older) : 1;
    if (past->n_known == 1) { /* as if the step before had moved as little, or as much */
        for (int i = 0; i < extremes->n; i++) {
            past->older[i] = 2 * past->values[i] - past->ends[i];
        }
    }
    const double t[3] = {past->t, 0.5 * (past->t + to), to};
    bool has_middle = false;
    if (!any_may_exceed(extremes->n_padded, past, ratio, extremes->high, extremes->low)) {
        return;
    }
    take(extremes, to);
    for (int i = 0; i < extremes->n; i++) {
        for (int sense = -1; sense <= 1; sense += 2) {
            if (!may_exceed(extremes, i, ratio) || !may_turn(extremes, i, sense, ratio)) {
                continue;
            }
            if (!has_middle && !see_at(extremes, step, t[1])) {
                return;
            }
            if (!has_middle) {
                memcpy(extremes->middle, extremes->values, (size_t)extremes->n * sizeof(double));
                has_middle = true;
            }
            take_middle(extremes, step, t, i, sense);
        }
    }
}

/** The state last seen is the one from which the next step goes on. */
static void remember(channel_past *past, double t)
{
    double *free_values = past->older;
    past->older = past->values;
    past->values = past->ends;
    past->ends = free_values;
    past->t_older = past->t;
    past->t = t;
    past->n_known++;
}

static bool know_end(extremes *extremes, const integrate_step *step, double t)
{
    const bool good = know_at(extremes, step, t);
    memcpy(extremes->past.ends, extremes->values, (size_t)extremes->n * sizeof(double));
    return good;
}

static void watch_by_ends(extremes *extremes, const integrate_step *step, double from, double to)
{
    channel_past *past = &extremes->past;
    if (!step->continues || past->t < from) {
        past->n_known = 0;
    }
    if (past->n_known == 0 && from < to && know_end(extremes, step, from)) {
        take(extremes, from);
        remember(past, from);
    }
    if (!know_end(extremes, step, to)) {
        past->n_known = 0;
        return;
    }
    if (past->n_known > 0) {
        take_ends(extremes, step, to);
    } else {
        take(extremes, to);
    }
    remember(past, to);
}

/* ---- any step ---- */

void extremes_watch(extremes *extremes, const integrate_step *step)
{
    extremes->t_values = NAN;
    if (step->t_to < extremes->from || step->t_from > extremes->to) {
        extremes->past.n_known = 0;
        return;
    }
    const double from = step->t_from > extremes->from ? step->t_from : extremes->from;
    const double to = step->t_to < extremes->to ? step->t_to : extremes->to;
    if (step->look == NULL) {
        watch_by_ends(extremes, step, from, to);
        return;
    }
    if (!extremes->has_begun || from > step->t_from || to < step->t_to) {
        (void)see_at(extremes, step, from);
        (void)see_at(extremes, step, to);
    }
    if (from < to) {
        take_candidates(extremes, step, from, to);
    }
}
