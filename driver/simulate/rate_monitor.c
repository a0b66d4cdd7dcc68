#include "simulate/rate_monitor.h"

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

/* The first step is checked, then one of 32, one of 128 and one of 512 for the rest of the run. A check is delayed by
 * up to an eighth of the interval until the first step after an event. */
enum { FIRST_INTERVAL = 32, LAST_INTERVAL = 512, PATIENCE = 8 };

/** The step with the largest difference of an integral from the change. */
typedef struct {
    double most;   /**< largest change in a step */
    double excess; /**< largest difference beyond rounding and tolerance, and its step: */
    double from, to, integral, change;
} rate_difference;

struct rate_monitor {
    memory_arena arena;
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

rate_monitor *rate_monitor_create(const model *model, double tolerance)
{
    rate_monitor *monitor = xcalloc(1, sizeof *monitor);
    *monitor = (rate_monitor){
        .model = model, .tolerance = tolerance, .steps = LAST_INTERVAL, .interval = FIRST_INTERVAL / 4, .node = END};
    memory_arena *arena = &monitor->arena;
    monitor->channels = rate_channels_open(model, arena);
    const size_t n_states = (size_t)model_about(model)->dae.n, n_values = (size_t)monitor->channels.values.n_values;
    const size_t n = (size_t)monitor->channels.n;
    monitor->y = arena_calloc(arena, n_states * DAE_LANES, sizeof *monitor->y);
    monitor->one = arena_calloc(arena, n_states, sizeof *monitor->one);
    monitor->values = arena_calloc(arena, n_values * DAE_LANES, sizeof *monitor->values);
    monitor->alone = arena_calloc(arena, n_values, sizeof *monitor->alone);
    monitor->largest = arena_calloc(arena, n_values, sizeof *monitor->largest);
    monitor->rates = arena_calloc(arena, n, sizeof *monitor->rates);
    monitor->near = arena_calloc(arena, n, sizeof *monitor->near);
    monitor->sums = arena_calloc(arena, n, sizeof *monitor->sums);
    monitor->allowed = arena_calloc(arena, n, sizeof *monitor->allowed);
    monitor->differences = arena_calloc(arena, n, sizeof *monitor->differences);
    return monitor;
}

void rate_monitor_delete(rate_monitor **pointer)
{
    rate_monitor *monitor = *pointer;
    *pointer = NULL;
    if (monitor != NULL) {
        rate_channels_close(&monitor->channels);
        arena_free(&monitor->arena);
        free(monitor);
    }
}

void rate_monitor_serialize(rate_monitor *monitor, archive *archive)
{
    SERIALIZE_ARRAY(archive, monitor->largest, monitor->channels.values.n_values);
    for (int i = 0; i < monitor->channels.n; i++) {
        rate_difference *difference = &monitor->differences[i];
        SERIALIZE(archive, difference->most);
        SERIALIZE(archive, difference->excess);
        SERIALIZE(archive, difference->from);
        SERIALIZE(archive, difference->to);
        SERIALIZE(archive, difference->integral);
        SERIALIZE(archive, difference->change);
    }
    SERIALIZE(archive, monitor->steps);
    SERIALIZE(archive, monitor->interval);
    SERIALIZE(archive, monitor->node);
    SERIALIZE(archive, monitor->after_event);
}

/* ---- messages ---- */

static const char defect[] = "this is a defect of the program, not of the case; please report it with the case";

/** Report two evaluations of an output that differ. */
static void note_difference(rate_monitor *monitor, int index, double lanes, double alone)
{
    char element[96];
    const model_output *output = rate_channels_output(&monitor->channels, index, element);
    (void)snprintf(monitor->text, sizeof monitor->text,
                   "at t = %.9g s %s%s is %.9g %s by the formulas for one state and %.9g by those for eight: %s",
                   monitor->t[monitor->node], output->name, element, alone, output->units, lanes, defect);
    monitor->has_conflict = true;
}

/* ---- a step ---- */

/** The states at the nodes. */
static bool find_states(rate_monitor *monitor, const integrate_step *step)
{
    const int n_states = model_about(monitor->model)->dae.n;
    for (int k = 0; k < DAE_LANES; k++) {
        monitor->t[k] = k == END ? step->t_to : step->t_from + (step->t_to - step->t_from) * nodes[k];
    }
    if (step->interpolate_lanes != NULL) {
        step->interpolate_lanes(step->with, monitor->t, monitor->y);
        return true;
    }
    bool good = true;
    for (int k = 0; k < DAE_LANES && good; k++) {
        good = step->interpolate(step->with, monitor->t[k], monitor->one);
        for (int i = 0; i < n_states; i++) {
            monitor->y[i * DAE_LANES + k] = monitor->one[i];
        }
    }
    return good;
}

/** The state at a node. */
static void take_state(rate_monitor *monitor, int node)
{
    for (int i = 0; i < model_about(monitor->model)->dae.n; i++) {
        monitor->one[i] = monitor->y[i * DAE_LANES + node];
    }
}

/** Compare the outputs of eight states at once with those of one. */
static void compare_formulas(rate_monitor *monitor, const integrate_step *step)
{
    char message[DAE_MESSAGE_LENGTH];
    const int node = monitor->node;
    take_state(monitor, node);
    if (model_sampler_ask(monitor->channels.sampler, 1, &monitor->t[node], monitor->one, step->state, monitor->alone,
                          message) != DAE_OK) {
        return;
    }
    for (int v = 0; v < monitor->channels.values.n_values && !monitor->has_conflict; v++) {
        const double lanes = monitor->values[v * DAE_LANES + node], alone = monitor->alone[v];
        if (!(fabs(lanes - alone) <= part * monitor->largest[v]) && !(isnan(lanes) && isnan(alone))) {
            note_difference(monitor, v, lanes, alone);
        }
    }
}

/** Integrals of the rates. Equation T72. */
static void integrate_rates(rate_monitor *monitor, double step)
{
    memset(monitor->sums, 0, (size_t)monitor->channels.n * sizeof *monitor->sums);
    for (int k = START + 1; k < DAE_LANES; k++) {
        rate_channels_rates(&monitor->channels, monitor->values, k, monitor->rates);
        for (int c = 0; c < monitor->channels.n; c++) {
            monitor->sums[c] += step * weights[k] * monitor->rates[c];
        }
    }
}

/** Permitted differences of the integrals: sum of the effects of perturbing each state by the tolerance.
 *  Equation T72.
 *  @return false if the rates there are not available */
static bool find_allowed(rate_monitor *monitor, const integrate_step *step)
{
    const rate_channels *channels = &monitor->channels;
    const dae *dae = &model_about(monitor->model)->dae;
    const double length = monitor->t[END] - monitor->t[START];
    const double tolerances = step->interpolate_lanes != NULL ? tolerances_of_collocation : tolerances_of_polynomials;
    char message[DAE_MESSAGE_LENGTH];
    double t[DAE_LANES];
    ARENA_SCOPE memory_arena arena = {NULL};
    double *y = arena_calloc(&arena, (size_t)dae->n * DAE_LANES, sizeof *y);
    double *values = arena_calloc(&arena, (size_t)channels->values.n_values * DAE_LANES, sizeof *values);
    memset(monitor->allowed, 0, (size_t)channels->n * sizeof *monitor->allowed);
    rate_channels_rates(channels, monitor->values, END, monitor->rates);
    for (int first = 0; first < dae->n; first += DAE_LANES) {
        for (int k = 0; k < DAE_LANES; k++) {
            t[k] = monitor->t[END];
            for (int i = 0; i < dae->n; i++) {
                const double change = i == first + k ? tolerances * monitor->tolerance * dae->scale[i] : 0;
                y[(size_t)i * DAE_LANES + (size_t)k] = monitor->y[(size_t)i * DAE_LANES + END] + change;
            }
        }
        if (model_sampler_ask(channels->sampler, DAE_LANES, t, y, step->state, values, message) != DAE_OK) {
            return false;
        }
        for (int k = 0; k < DAE_LANES; k++) {
            rate_channels_rates(channels, values, k, monitor->near);
            for (int c = 0; c < channels->n; c++) {
                const size_t index = (size_t)channels->channels[c].index * DAE_LANES;
                monitor->allowed[c] += length * fabs(monitor->near[c] - monitor->rates[c]) +
                                       fabs(values[index + (size_t)k] - monitor->values[index + END]);
            }
        }
    }
    return true;
}

/** Compare the integrals with the changes. Equation T72. */
static void compare_changes(rate_monitor *monitor)
{
    const double step = monitor->t[END] - monitor->t[START];
    integrate_rates(monitor, step);
    for (int c = 0; c < monitor->channels.n; c++) {
        rate_difference *largest = &monitor->differences[c];
        const double *values = monitor->values + (size_t)monitor->channels.channels[c].index * DAE_LANES;
        const double change = values[END] - values[START], integral = monitor->sums[c];
        const double rounding =
            roundings * (fabs(values[START]) + fabs(values[END]) + fabs(integral / step) * fabs(monitor->t[END]));
        const double excess = fabs(integral - change) - rounding - monitor->allowed[c];
        largest->most = fmax(largest->most, fabs(change));
        if (excess > largest->excess) {
            largest->excess = excess;
            largest->from = monitor->t[START];
            largest->to = monitor->t[END];
            largest->integral = integral;
            largest->change = change;
        }
    }
}

static void look(rate_monitor *monitor, const integrate_step *step)
{
    char message[DAE_MESSAGE_LENGTH];
    if (!find_states(monitor, step)) {
        return;
    }
    if (model_sampler_ask(monitor->channels.sampler, DAE_LANES, monitor->t, monitor->y, step->state, monitor->values,
                          message) != DAE_OK) {
        return;
    }
    for (int v = 0; v < monitor->channels.values.n_values; v++) {
        for (int k = 0; k < DAE_LANES; k++) {
            monitor->largest[v] = fmax(monitor->largest[v], fabs(monitor->values[v * DAE_LANES + k]));
        }
    }
    if (monitor->channels.in_lanes) {
        compare_formulas(monitor, step);
    }
    if (find_allowed(monitor, step)) {
        compare_changes(monitor);
    }
    monitor->node = monitor->node == 1 ? END : monitor->node - 1;
}

void rate_monitor_step(rate_monitor *monitor, const integrate_step *step)
{
    monitor->steps++;
    const long least = monitor->interval, most = least + least / PATIENCE;
    const bool is_due = monitor->steps >= (monitor->after_event ? least : most);
    monitor->after_event = false;
    if (is_due && step->t_to > step->t_from && !monitor->has_conflict) {
        monitor->steps = 0;
        monitor->interval = monitor->interval < LAST_INTERVAL ? 4 * monitor->interval : LAST_INTERVAL;
        look(monitor, step);
    }
}

void rate_monitor_event(rate_monitor *monitor)
{
    monitor->after_event = true;
}

const char *rate_monitor_conflict(const rate_monitor *monitor)
{
    return monitor->has_conflict ? monitor->text : NULL;
}

const char *rate_monitor_conclude(rate_monitor *monitor)
{
    char element[96];
    for (int c = 0; c < monitor->channels.n && !monitor->has_conflict; c++) {
        const rate_difference *largest = &monitor->differences[c];
        const rate_channel *channel = &monitor->channels.channels[c];
        if (!(largest->excess <= part * largest->most)) {
            const model_output *output = rate_channels_output(&monitor->channels, channel->index, element);
            (void)snprintf(monitor->text, sizeof monitor->text,
                           "from t = %.9g s to %.9g s %s%s changes by %.9g %s, but the integral of %s is %.9g: %s",
                           largest->from, largest->to, output->name, element, largest->change, output->units,
                           channel->rate == NULL ? (channel->is_power ? "the power of the loads" : "its rates")
                                                 : channel->rate->name,
                           largest->integral, defect);
            monitor->has_conflict = true;
        }
    }
    return rate_monitor_conflict(monitor);
}
