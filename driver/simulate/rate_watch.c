#include "simulate/rate_watch.h"

#include "base/memory.h"
#include "simulate/rate_channels.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The start of a step and the nodes of Radau quadrature of order 13, in units of the step; the last node is its end.
 * They are the stages of a radau step: then the sum of the rates equals the change up to the error of Newton's
 * iteration, for any step size. */
static const double nodes[DAE_LANES] = {0,
                                        0.02931642715978489197,
                                        0.1480785996684842918,
                                        0.3369846902811542991,
                                        0.5586715187715501321,
                                        0.7692338620300545009,
                                        0.9269456713197411149,
                                        1};
static const double weights[DAE_LANES] = {0,
                                          0.07449423555601031793,
                                          0.1591021157336507409,
                                          0.2123518895029778042,
                                          0.2235549145072832347,
                                          0.1904749368221155769,
                                          0.1196137446126562029,
                                          0.02040816326530612245};
enum { START = 0, END = DAE_LANES - 1 };

static const double part = 1e-8; /* permitted difference of two formulas, relative to the largest value or change */
/* Permitted error, in tolerances, of a state between the ends of a step; its effect on an integral is computed by
 * perturbing the states. Radau's steps are collocations: only Newton's iteration contributes, by at most 0.3 tolerances
 * in 400 random cases. IDA's polynomials satisfy the equations only at their ends: 7.8 in the same cases, in the short
 * steps after an event. */
static const double tolerances_of_collocation = 10, tolerances_of_polynomials = 100;
static const double roundings = 64 * DBL_EPSILON; /* of subtracted values, and of the time */

/* The first step is checked, then one of 32, of 64, ... and one of 512 for the rest of the run. A check is delayed by
 * up to an eighth of the interval until the first step after an event. */
enum { FIRST_INTERVAL = 32, LAST_INTERVAL = 512, PATIENCE = 8 };

/** The step with the largest difference of an integral from the change. */
typedef struct {
    double most;   /**< largest change in a step */
    double excess; /**< largest difference beyond rounding and tolerance, and its step: */
    double from, to, integral, change;
} rate_difference;

struct rate_watch {
    memory_pool pool;
    const model *model;
    double tolerance;
    rate_channels channels;
    double t[DAE_LANES];
    double *y, *one;              /**< [states * DAE_LANES], [states] */
    double *values, *alone;       /**< [n_values * DAE_LANES], [n_values] */
    double *largest;              /**< [n_values] so far */
    double *rates, *near, *sums;  /**< [n of channels] at a state, at a perturbed one; integrals over a step */
    double *allowed;              /**< [n of channels] effect of the state errors on the integrals */
    rate_difference *differences; /**< [n of channels] */
    long steps;                   /**< since the last checked one; initially large enough for a check */
    long interval;                /**< present interval between checks */
    int node;                     /**< at which the outputs of one state are evaluated next */
    bool after_event;
    bool has_conflict;
    char text[DAE_MESSAGE_LENGTH];
};

rate_watch *rate_watch_create(const model *model, double tolerance)
{
    rate_watch *watch = xcalloc(1, sizeof *watch);
    *watch = (rate_watch){
        .model = model, .tolerance = tolerance, .steps = LAST_INTERVAL, .interval = FIRST_INTERVAL / 2, .node = END};
    memory_pool *pool = &watch->pool;
    watch->channels = rate_channels_open(model, pool);
    const size_t n_states = (size_t)model_about(model)->dae.n, n_values = (size_t)watch->channels.values.n_values;
    const size_t n = (size_t)watch->channels.n;
    watch->y = pool_calloc(pool, n_states * DAE_LANES, sizeof *watch->y);
    watch->one = pool_calloc(pool, n_states, sizeof *watch->one);
    watch->values = pool_calloc(pool, n_values * DAE_LANES, sizeof *watch->values);
    watch->alone = pool_calloc(pool, n_values, sizeof *watch->alone);
    watch->largest = pool_calloc(pool, n_values, sizeof *watch->largest);
    watch->rates = pool_calloc(pool, n, sizeof *watch->rates);
    watch->near = pool_calloc(pool, n, sizeof *watch->near);
    watch->sums = pool_calloc(pool, n, sizeof *watch->sums);
    watch->allowed = pool_calloc(pool, n, sizeof *watch->allowed);
    watch->differences = pool_calloc(pool, n, sizeof *watch->differences);
    return watch;
}

void rate_watch_delete(rate_watch **pointer)
{
    rate_watch *watch = *pointer;
    *pointer = NULL;
    if (watch != NULL) {
        rate_channels_close(&watch->channels);
        pool_free(&watch->pool);
        free(watch);
    }
}

void rate_watch_keep(rate_watch *watch, archive *archive)
{
    KEEP_ARRAY(archive, watch->largest, watch->channels.values.n_values);
    for (int i = 0; i < watch->channels.n; i++) {
        rate_difference *difference = &watch->differences[i];
        KEEP(archive, difference->most);
        KEEP(archive, difference->excess);
        KEEP(archive, difference->from);
        KEEP(archive, difference->to);
        KEEP(archive, difference->integral);
        KEEP(archive, difference->change);
    }
    KEEP(archive, watch->steps);
    KEEP(archive, watch->interval);
    KEEP(archive, watch->node);
    KEEP(archive, watch->after_event);
}

/* ---- messages ---- */

static const char defect[] = "this is a defect of the program, not of the case: please report it with the case";

/** Report two evaluations of an output that differ. */
static void note_difference(rate_watch *watch, int place, double lanes, double alone)
{
    char element[96];
    const model_output *output = rate_channels_output(&watch->channels, place, element);
    (void)snprintf(watch->text, sizeof watch->text,
                   "at t = %.9g s %s%s is %.9g %s by the formulas for one state and %.9g by those for eight: %s",
                   watch->t[watch->node], output->name, element, alone, output->units, lanes, defect);
    watch->has_conflict = true;
}

/* ---- a step ---- */

/** The states at the nodes. */
static bool find_states(rate_watch *watch, const integrate_step *step)
{
    const int n_states = model_about(watch->model)->dae.n;
    for (int k = 0; k < DAE_LANES; k++) {
        watch->t[k] = k == END ? step->t_to : step->t_from + (step->t_to - step->t_from) * nodes[k];
    }
    if (step->interpolate_lanes != NULL) {
        step->interpolate_lanes(step->with, watch->t, watch->y);
        return true;
    }
    bool good = true;
    for (int k = 0; k < DAE_LANES && good; k++) {
        good = step->interpolate(step->with, watch->t[k], watch->one);
        for (int i = 0; i < n_states; i++) {
            watch->y[i * DAE_LANES + k] = watch->one[i];
        }
    }
    return good;
}

/** The state at a node. */
static void take_state(rate_watch *watch, int node)
{
    for (int i = 0; i < model_about(watch->model)->dae.n; i++) {
        watch->one[i] = watch->y[i * DAE_LANES + node];
    }
}

/** Compare the outputs of eight states at once with those of one. */
static void compare_formulas(rate_watch *watch, const integrate_step *step)
{
    char message[DAE_MESSAGE_LENGTH];
    const int node = watch->node;
    take_state(watch, node);
    if (model_sampler_ask(watch->channels.sampler, 1, &watch->t[node], watch->one, step->state, watch->alone,
                          message) != DAE_OK) {
        return;
    }
    for (int v = 0; v < watch->channels.values.n_values && !watch->has_conflict; v++) {
        const double lanes = watch->values[v * DAE_LANES + node], alone = watch->alone[v];
        if (!(fabs(lanes - alone) <= part * watch->largest[v]) && !(isnan(lanes) && isnan(alone))) {
            note_difference(watch, v, lanes, alone);
        }
    }
}

/** Integrals of the rates. Equation T72. */
static void integrate_rates(rate_watch *watch, double step)
{
    memset(watch->sums, 0, (size_t)watch->channels.n * sizeof *watch->sums);
    for (int k = START + 1; k < DAE_LANES; k++) {
        rate_channels_rates(&watch->channels, watch->values, k, watch->rates);
        for (int c = 0; c < watch->channels.n; c++) {
            watch->sums[c] += step * weights[k] * watch->rates[c];
        }
    }
}

/** Permitted differences of the integrals: sum of the effects of perturbing each state by the tolerance.
 *  Equation T72.
 *  @return false if the rates there are not available */
static bool find_allowed(rate_watch *watch, const integrate_step *step)
{
    const rate_channels *channels = &watch->channels;
    const dae *dae = &model_about(watch->model)->dae;
    const double length = watch->t[END] - watch->t[START];
    const double tolerances = step->interpolate_lanes != NULL ? tolerances_of_collocation : tolerances_of_polynomials;
    char message[DAE_MESSAGE_LENGTH];
    double t[DAE_LANES];
    POOLED memory_pool pool = {NULL};
    double *y = pool_calloc(&pool, (size_t)dae->n * DAE_LANES, sizeof *y);
    double *values = pool_calloc(&pool, (size_t)channels->values.n_values * DAE_LANES, sizeof *values);
    memset(watch->allowed, 0, (size_t)channels->n * sizeof *watch->allowed);
    rate_channels_rates(channels, watch->values, END, watch->rates);
    for (int first = 0; first < dae->n; first += DAE_LANES) {
        for (int k = 0; k < DAE_LANES; k++) {
            t[k] = watch->t[END];
            for (int i = 0; i < dae->n; i++) {
                const double change = i == first + k ? tolerances * watch->tolerance * dae->scale[i] : 0;
                y[(size_t)i * DAE_LANES + (size_t)k] = watch->y[(size_t)i * DAE_LANES + END] + change;
            }
        }
        if (model_sampler_ask(channels->sampler, DAE_LANES, t, y, step->state, values, message) != DAE_OK) {
            return false;
        }
        for (int k = 0; k < DAE_LANES; k++) {
            rate_channels_rates(channels, values, k, watch->near);
            for (int c = 0; c < channels->n; c++) {
                const size_t place = (size_t)channels->channels[c].place * DAE_LANES;
                watch->allowed[c] += length * fabs(watch->near[c] - watch->rates[c]) +
                                     fabs(values[place + (size_t)k] - watch->values[place + END]);
            }
        }
    }
    return true;
}

/** Compare the integrals with the changes. Equation T72. */
static void compare_changes(rate_watch *watch)
{
    const double step = watch->t[END] - watch->t[START];
    integrate_rates(watch, step);
    for (int c = 0; c < watch->channels.n; c++) {
        rate_difference *largest = &watch->differences[c];
        const double *values = watch->values + (size_t)watch->channels.channels[c].place * DAE_LANES;
        const double change = values[END] - values[START], integral = watch->sums[c];
        const double rounding =
            roundings * (fabs(values[START]) + fabs(values[END]) + fabs(integral / step) * fabs(watch->t[END]));
        const double excess = fabs(integral - change) - rounding - watch->allowed[c];
        largest->most = fmax(largest->most, fabs(change));
        if (excess > largest->excess) {
            largest->excess = excess;
            largest->from = watch->t[START];
            largest->to = watch->t[END];
            largest->integral = integral;
            largest->change = change;
        }
    }
}

static void look(rate_watch *watch, const integrate_step *step)
{
    char message[DAE_MESSAGE_LENGTH];
    if (!find_states(watch, step)) {
        return;
    }
    if (model_sampler_ask(watch->channels.sampler, DAE_LANES, watch->t, watch->y, step->state, watch->values,
                          message) != DAE_OK) {
        return;
    }
    for (int v = 0; v < watch->channels.values.n_values; v++) {
        for (int k = 0; k < DAE_LANES; k++) {
            watch->largest[v] = fmax(watch->largest[v], fabs(watch->values[v * DAE_LANES + k]));
        }
    }
    if (watch->channels.in_lanes) {
        compare_formulas(watch, step);
    }
    if (find_allowed(watch, step)) {
        compare_changes(watch);
    }
    watch->node = watch->node == 1 ? END : watch->node - 1;
}

void rate_watch_step(rate_watch *watch, const integrate_step *step)
{
    watch->steps++;
    const long least = watch->interval, most = least + least / PATIENCE;
    const bool is_due = watch->steps >= (watch->after_event ? least : most);
    watch->after_event = false;
    if (is_due && step->t_to > step->t_from && !watch->has_conflict) {
        watch->steps = 0;
        watch->interval = watch->interval < LAST_INTERVAL ? 2 * watch->interval : LAST_INTERVAL;
        look(watch, step);
    }
}

void rate_watch_event(rate_watch *watch)
{
    watch->after_event = true;
}

const char *rate_watch_conflict(const rate_watch *watch)
{
    return watch->has_conflict ? watch->text : NULL;
}

const char *rate_watch_conclude(rate_watch *watch)
{
    char element[96];
    for (int c = 0; c < watch->channels.n && !watch->has_conflict; c++) {
        const rate_difference *largest = &watch->differences[c];
        const rate_channel *channel = &watch->channels.channels[c];
        if (!(largest->excess <= part * largest->most)) {
            const model_output *output = rate_channels_output(&watch->channels, channel->place, element);
            (void)snprintf(watch->text, sizeof watch->text,
                           "from t = %.9g s to %.9g s %s%s changes by %.9g %s, but the integral of %s is %.9g: %s",
                           largest->from, largest->to, output->name, element, largest->change, output->units,
                           channel->rate == NULL ? (channel->is_power ? "the power of the loads" : "its rates")
                                                 : channel->rate->name,
                           largest->integral, defect);
            watch->has_conflict = true;
        }
    }
    return rate_watch_conflict(watch);
}
