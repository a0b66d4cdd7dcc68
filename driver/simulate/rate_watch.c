#include "simulate/rate_watch.h"

#include "base/memory.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The start of a step and the nodes of Radau's quadrature of order 13, the last of which is its end, in units of the step. A step of
 * radau has its stages there: then the sum of the rates is the change up to the error of Newton's iteration, whatever the step. */
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

static const double part = 1e-8; /* of the largest value or change: what two formulas may differ by */
/* Units of the tolerance, in scales of the states, that the integral over one step may be wrong by: Newton's iteration of radau,
 * which in a step of many periods of a stiff mode leaves much of its acceleration. */
static const double tolerances = 1e4;
static const double roundings = 64 * DBL_EPSILON; /* of values that are subtracted, and of the time */

/* The first step is looked at, then one of 16, of 32, of 64, and one of 128 for the rest of the run: later by up to an eighth of that
 * where it is the first after an event then. */
enum { FIRST_INTERVAL = 16, LAST_INTERVAL = 128, PATIENCE = 8 };

/** One value and its rate, or the sum of all its rates. */
typedef struct {
    const model_output *of, *rate; /**< rate: NULL if several add up to it */
    int element, place;            /**< of the output; among the values */
    bool is_power;                 /**< the work of the loads: its rate is the sum of torques times speeds */
    double most;                   /**< largest change in a step */
    double scale;                  /**< by how much it changes if the states change by their scales */
    double excess;                 /**< largest difference beyond rounding, and where that was: */
    double from, to, integral, change;
} rate_channel;

struct rate_watch {
    memory_pool pool;
    const model *model;
    double tolerance;
    int n, *outputs; /**< [n] indices of the outputs that are evaluated */
    int n_values;    /**< of all of them */
    int *places;     /**< [n_outputs of the model] first value of each; -1: not evaluated */
    int n_channels;
    rate_channel *channels;
    int *channel_of;   /**< [n_values] to which channel a rate belongs; -1: to none */
    int torque, speed; /**< first values of the wheels */
    bool in_lanes;     /**< the model evaluates eight states at once */
    model_sampler *sampler;
    double t[DAE_LANES];
    double *y, *one;        /**< [states * DAE_LANES], [states] */
    double *values, *alone; /**< [n_values * DAE_LANES], [n_values] */
    double *largest;        /**< [n_values] so far */
    double *sums;           /**< [n_channels] integrals over a step */
    long steps;             /**< since the last that was looked at; before the first one, enough */
    long interval;          /**< of those that are looked at, at present */
    int node;               /**< at which the outputs of one state are evaluated next */
    bool after_event;
    bool has_conflict;
    char text[DAE_MESSAGE_LENGTH];
};

/* ---- what is compared ---- */

/** Evaluate an output. @return the place of its first value; -1 if the model does not have it */
static int evaluate(rate_watch *watch, const char *name)
{
    const model_output *output = model_output_named(watch->model, name);
    if (output == NULL || output->count == 0) {
        return -1;
    }
    const int index = (int)(output - model_about(watch->model)->outputs);
    if (watch->places[index] < 0) {
        watch->places[index] = watch->n_values;
        watch->outputs[watch->n++] = index;
        watch->n_values += output->count;
    }
    return watch->places[index];
}

static int count_of(const model *model, const char *name)
{
    const model_output *output = model_output_named(model, name);
    return output == NULL ? 0 : output->count;
}

/** Whether an output is a rate in this run. The pose of a housing that moves as prescribed is no state: nothing integrates it. */
static bool is_rate(const model *model, const model_output *output)
{
    static const char prefix[] = "housing_";
    const bool is_mounted = count_of(model, "mount_damping_loss") > 0;
    return output->rate_of != NULL && output->count > 0 && count_of(model, output->rate_of) > 0 &&
           (is_mounted || strncmp(output->name, prefix, strlen(prefix)) != 0);
}

/** The channel of a value; a new one if there is none yet. */
static int channel_at(rate_watch *watch, const model_output *of, int element)
{
    const int place = watch->places[of - model_about(watch->model)->outputs] + element;
    for (int i = 0; i < watch->n_channels; i++) {
        if (watch->channels[i].place == place) {
            return i;
        }
    }
    watch->channels[watch->n_channels] = (rate_channel){.of = of, .element = element, .place = place};
    return watch->n_channels++;
}

static void open_rate(rate_watch *watch, const model_output *rate)
{
    const model_output *of = model_output_named(watch->model, rate->rate_of);
    const bool adds_up = of->count != rate->count;
    const int first = watch->places[rate - model_about(watch->model)->outputs];
    for (int i = 0; i < rate->count; i++) {
        const int channel = channel_at(watch, of, adds_up ? 0 : i);
        watch->channel_of[first + i] = channel;
        watch->channels[channel].rate = of->dims[0] == '\0' && strcmp(of->units, "J") == 0 ? NULL : rate;
    }
}

static void open_channels(rate_watch *watch)
{
    const model_facts *about = model_about(watch->model);
    memory_pool *pool = &watch->pool;
    for (int i = 0; i < about->n_outputs; i++) {
        if (is_rate(watch->model, &about->outputs[i])) {
            (void)evaluate(watch, about->outputs[i].name);
            (void)evaluate(watch, about->outputs[i].rate_of);
        }
    }
    watch->torque = evaluate(watch, "load_torque");
    watch->speed = evaluate(watch, "angular_velocity");
    const int work = evaluate(watch, "load_work");
    watch->channels = pool_calloc(pool, (size_t)watch->n_values, sizeof *watch->channels);
    watch->channel_of = pool_calloc(pool, (size_t)watch->n_values, sizeof *watch->channel_of);
    for (int i = 0; i < watch->n_values; i++) {
        watch->channel_of[i] = -1;
    }
    for (int i = 0; i < about->n_outputs; i++) {
        if (is_rate(watch->model, &about->outputs[i])) {
            open_rate(watch, &about->outputs[i]);
        }
    }
    watch->sampler = model_sampler_create(watch->model, watch->n, watch->outputs);
    watch->in_lanes = model_sampler_in_lanes(watch->sampler);
    if (watch->in_lanes && work >= 0) { /* else a housing that moves, or gravity, may add to it */
        const int channel = channel_at(watch, model_output_named(watch->model, "load_work"), 0);
        watch->channels[channel].is_power = true;
    }
}

rate_watch *rate_watch_create(const model *model, double tolerance)
{
    const model_facts *about = model_about(model);
    rate_watch *watch = xcalloc(1, sizeof *watch);
    *watch = (rate_watch){
        .model = model, .tolerance = tolerance, .steps = LAST_INTERVAL, .interval = FIRST_INTERVAL / 2, .node = END};
    memory_pool *pool = &watch->pool;
    watch->outputs = pool_calloc(pool, (size_t)about->n_outputs, sizeof *watch->outputs);
    watch->places = pool_calloc(pool, (size_t)about->n_outputs, sizeof *watch->places);
    for (int i = 0; i < about->n_outputs; i++) {
        watch->places[i] = -1;
    }
    open_channels(watch);
    const size_t n_states = (size_t)about->dae.n, n_values = (size_t)watch->n_values;
    watch->y = pool_calloc(pool, n_states * DAE_LANES, sizeof *watch->y);
    watch->one = pool_calloc(pool, n_states, sizeof *watch->one);
    watch->values = pool_calloc(pool, n_values * DAE_LANES, sizeof *watch->values);
    watch->alone = pool_calloc(pool, n_values, sizeof *watch->alone);
    watch->largest = pool_calloc(pool, n_values, sizeof *watch->largest);
    watch->sums = pool_calloc(pool, (size_t)watch->n_channels, sizeof *watch->sums);
    return watch;
}

void rate_watch_delete(rate_watch **pointer)
{
    rate_watch *watch = *pointer;
    *pointer = NULL;
    if (watch != NULL) {
        model_sampler_delete(&watch->sampler);
        pool_free(&watch->pool);
        free(watch);
    }
}

void rate_watch_keep(rate_watch *watch, archive *archive)
{
    KEEP_ARRAY(archive, watch->largest, watch->n_values);
    for (int i = 0; i < watch->n_channels; i++) {
        rate_channel *channel = &watch->channels[i];
        KEEP(archive, channel->most);
        KEEP(archive, channel->scale);
        KEEP(archive, channel->excess);
        KEEP(archive, channel->from);
        KEEP(archive, channel->to);
        KEEP(archive, channel->integral);
        KEEP(archive, channel->change);
    }
    KEEP(archive, watch->steps);
    KEEP(archive, watch->interval);
    KEEP(archive, watch->node);
    KEEP(archive, watch->after_event);
}

/* ---- what is said of a difference ---- */

/** Of what an element of an output is: " of wheel 'gear', x", or nothing. */
static void write_element(const rate_watch *watch, const model_output *output, int element, char text[96])
{
    const model_names *names = &model_about(watch->model)->names;
    const struct {
        const char *dim;
        const name_list *of;
    } lists[] = {{"wheel", &names->wheels}, {"mesh", &names->meshes}, {"shaft", &names->shafts}};
    text[0] = '\0';
    for (size_t i = 0; i < sizeof lists / sizeof *lists; i++) {
        const size_t length = strlen(lists[i].dim);
        if (strncmp(output->dims, lists[i].dim, length) == 0 && lists[i].of->n > 0) {
            const int each = output->count / lists[i].of->n;
            (void)snprintf(text, 96, " of %s '%.60s'%s", lists[i].dim, lists[i].of->names[element / each],
                           each != 2            ? ""
                           : element % each > 0 ? ", y"
                                                : ", x");
        }
    }
}

static const char defect[] = "this is a defect of the program, not of the case: please report it with the case";

/** Two evaluations of an output that differ. */
static void note_difference(rate_watch *watch, int place, double lanes, double alone)
{
    const model_facts *about = model_about(watch->model);
    char element[96];
    for (int i = 0; i < watch->n; i++) {
        const model_output *output = &about->outputs[watch->outputs[i]];
        const int first = watch->places[watch->outputs[i]];
        if (place >= first && place < first + output->count) {
            write_element(watch, output, place - first, element);
            (void)snprintf(
                watch->text, sizeof watch->text,
                "at t = %.9g s %s%s is %.9g %s by the formulas for one state and %.9g by those for eight: %s",
                watch->t[watch->node], output->name, element, alone, output->units, lanes, defect);
            watch->has_conflict = true;
            return;
        }
    }
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

/** By how much values change if states change by their scales, one after the other. */
static void find_scales(rate_watch *watch, const integrate_step *step)
{
    const dae *dae = &model_about(watch->model)->dae;
    char message[DAE_MESSAGE_LENGTH];
    POOLED memory_pool pool = {NULL};
    int *outputs = pool_calloc(&pool, (size_t)watch->n_channels, sizeof *outputs);
    double *before = pool_calloc(&pool, (size_t)watch->n_values, sizeof *before);
    double *after = pool_calloc(&pool, (size_t)watch->n_values, sizeof *after);
    int n = 0;
    for (int i = 0; i < watch->n_channels; i++) { /* their elements come one behind the other */
        const int index = (int)(watch->channels[i].of - model_about(watch->model)->outputs);
        if (n == 0 || outputs[n - 1] != index) {
            outputs[n++] = index;
        }
    }
    model_sampler *sampler = model_sampler_create(watch->model, n, outputs);
    take_state(watch, START);
    (void)model_sampler_ask(sampler, 1, watch->t, watch->one, step->state, before, message);
    for (int i = 0; i < dae->n; i++) {
        watch->one[i] += dae->scale[i];
        (void)model_sampler_ask(sampler, 1, watch->t, watch->one, step->state, after, message);
        watch->one[i] -= dae->scale[i];
        for (int c = 0, value = 0; c < watch->n_channels; c++, value++) {
            watch->channels[c].scale += fabs(after[value] - before[value]);
        }
    }
    model_sampler_delete(&sampler);
}

/** Compare the outputs of eight states at once with those of one. */
static void compare_formulas(rate_watch *watch, const integrate_step *step)
{
    char message[DAE_MESSAGE_LENGTH];
    const int node = watch->node;
    take_state(watch, node);
    if (model_sampler_ask(watch->sampler, 1, &watch->t[node], watch->one, step->state, watch->alone, message) !=
        DAE_OK) {
        return;
    }
    for (int v = 0; v < watch->n_values && !watch->has_conflict; v++) {
        const double lanes = watch->values[v * DAE_LANES + node], alone = watch->alone[v];
        if (!(fabs(lanes - alone) <= part * watch->largest[v]) && !(isnan(lanes) && isnan(alone))) {
            note_difference(watch, v, lanes, alone);
        }
    }
}

/** Integrals of the rates. */
static void integrate_rates(rate_watch *watch, double step)
{
    memset(watch->sums, 0, (size_t)watch->n_channels * sizeof *watch->sums);
    for (int v = 0; v < watch->n_values; v++) {
        const double *values = watch->values + (size_t)v * DAE_LANES;
        double sum = 0;
        for (int k = 0; k < DAE_LANES; k++) {
            sum += weights[k] * values[k];
        }
        if (watch->channel_of[v] >= 0) {
            watch->sums[watch->channel_of[v]] += step * sum;
        }
    }
    const int n_wheels = model_about(watch->model)->names.wheels.n;
    for (int c = 0; c < watch->n_channels; c++) {
        for (int i = 0; i < n_wheels && watch->channels[c].is_power; i++) {
            const double *torque = watch->values + (size_t)(watch->torque + i) * DAE_LANES;
            const double *speed = watch->values + (size_t)(watch->speed + i) * DAE_LANES;
            for (int k = 0; k < DAE_LANES; k++) {
                watch->sums[c] += step * weights[k] * torque[k] * speed[k];
            }
        }
    }
}

/** Compare them with the changes. */
static void compare_changes(rate_watch *watch)
{
    const double step = watch->t[END] - watch->t[START];
    integrate_rates(watch, step);
    for (int c = 0; c < watch->n_channels; c++) {
        rate_channel *channel = &watch->channels[c];
        const double *values = watch->values + (size_t)channel->place * DAE_LANES;
        const double change = values[END] - values[START], integral = watch->sums[c];
        const double rounding =
            roundings * (fabs(values[START]) + fabs(values[END]) + fabs(integral / step) * fabs(watch->t[END]));
        const double excess = fabs(integral - change) - rounding;
        channel->most = fmax(channel->most, fabs(change));
        if (excess > channel->excess) {
            channel->excess = excess;
            channel->from = watch->t[START];
            channel->to = watch->t[END];
            channel->integral = integral;
            channel->change = change;
        }
    }
}

static void look(rate_watch *watch, const integrate_step *step)
{
    char message[DAE_MESSAGE_LENGTH];
    dae_state state = *step->state;
    if (!find_states(watch, step)) {
        return;
    }
    take_state(watch, watch->node);
    state.t = watch->t[watch->node];
    state.y = watch->one;
    if (!model_loads_agree(watch->model, &state, part, message)) {
        (void)snprintf(watch->text, sizeof watch->text, "at t = %.9g s %.260s: %s", state.t, message, defect);
        watch->has_conflict = true;
        return;
    }
    if (model_sampler_ask(watch->sampler, DAE_LANES, watch->t, watch->y, step->state, watch->values, message) !=
        DAE_OK) {
        return;
    }
    for (int v = 0; v < watch->n_values; v++) {
        for (int k = 0; k < DAE_LANES; k++) {
            watch->largest[v] = fmax(watch->largest[v], fabs(watch->values[v * DAE_LANES + k]));
        }
    }
    if (watch->n_channels > 0 && !(watch->channels[0].scale > 0)) {
        find_scales(watch, step);
    }
    if (watch->in_lanes) {
        compare_formulas(watch, step);
    }
    if (step->interpolate_lanes != NULL) { /* IDA's polynomials meet no equation between their ends */
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
    for (int c = 0; c < watch->n_channels && !watch->has_conflict; c++) {
        const rate_channel *channel = &watch->channels[c];
        if (!(channel->excess <= part * channel->most + tolerances * watch->tolerance * channel->scale)) {
            write_element(watch, channel->of, channel->element, element);
            (void)snprintf(watch->text, sizeof watch->text,
                           "from t = %.9g s to %.9g s %s%s changes by %.9g %s, but the integral of %s is %.9g: %s",
                           channel->from, channel->to, channel->of->name, element, channel->change, channel->of->units,
                           channel->rate == NULL ? (channel->is_power ? "the power of the loads" : "its rates")
                                                 : channel->rate->name,
                           channel->integral, defect);
            watch->has_conflict = true;
        }
    }
    return rate_watch_conflict(watch);
}
