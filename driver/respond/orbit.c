#include "respond/orbit.h"

#include "base/interrupt.h"
#include "files/response.h"
#include "integrate/integrate.h"
#include "respond/shortcut.h"
#include "simulate/metrics.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

enum { N_STORED = ORBIT_LONGEST + 1, FIRST_LOOK = 40, LONGEST_LOOK = 4 };

/* ---- the search ---- */

typedef enum { STOP_NONE, STOP_DONE, STOP_INTERRUPTED, STOP_SHORTCUT } stop_reason;

typedef struct {
    const model *model;
    const dae *dae;
    section section;
    const integrate_options *options;
    settling settling;
    state_transfer orbit; /**< a stable orbit to which the motion may converge */
    double apart;         /**< distance from it when it was found */
    int next_look;        /**< common periods on this section after which it is searched */
    double repeats;       /**< distance below which states are regarded as equal */
    const volatile sig_atomic_t *interrupt;
    dae_state seen[N_STORED]; /**< on the section, shifted back to the same position */
    double t_seen[N_STORED];  /**< their times [s] */
    double far[N_STORED]
              [N_STORED]; /**< [section][orbit] distance to the state that number of periods before; NAN: unknown */
    int n_seen;           /**< since the last move of the section */
    dae_state at;         /**< the last one, not shifted */
    metrics *metrics;     /**< of the window, if started */
    double t_stop;        /**< end of the window [s] */
    long enough;          /**< pitches after which it may end earlier; 0: it does not */
    orbit_result *result;
    stop_reason stop;
} search;

/** Whether the motion repeats after p periods: the remaining distance to that orbit, extrapolated as a geometric series
 *  from the last two distances, is at most `repeats`; or the distances are only rounding. Equation RE1. */
static bool has_come_to(const search *s, int k, int p)
{
    static const double rounding = 0.01;
    const double now = s->far[k % N_STORED][p], before = s->far[(k - p) % N_STORED][p],
                 left = now * now / (before - now);
    const bool shrinks = now < before && now <= s->repeats && left <= s->repeats;
    return (shrinks || (now <= rounding * s->repeats && before <= rounding * s->repeats)) &&
           settling_is_calm(&s->settling, p);
}

/** Period of the orbit on which the motion is; 0: none yet. A motion that spirals into an orbit approaches its state
 *  several periods before earlier than its state one period before. So the shortest period that almost repeats is
 *  taken, once one repeats. */
static int find_period(const search *s, int k)
{
    static const double almost = 100;
    int found = 0;
    for (int p = 1; p <= ORBIT_LONGEST && 2 * p <= k && found == 0; p++) {
        found = has_come_to(s, k, p) ? p : 0;
    }
    for (int p = 1; p < found; p++) {
        found = s->far[k % N_STORED][p] <= almost * s->repeats ? p : found;
    }
    const bool is_there = found > 0 && s->far[k % N_STORED][found] <= s->repeats;
    return is_there && settling_is_calm(&s->settling, found) ? found : 0;
}

/** Duration of the last common period [s]. @param k  from 1 */
static double common_time(const search *s, int k)
{
    return s->section.period.by_time ? s->section.period.time : s->at.t - s->t_seen[(k - 1) % N_STORED];
}

/** Start the evaluation of metrics over whole pitches. @param n  common periods */
static void open_window(search *s, int n, double pitch)
{
    bool taken[N_METRIC_ROWS];
    for (int i = 0; i < N_METRIC_ROWS; i++) {
        taken[i] = i < METRICS_OF_ALL_MODELS;
    }
    const double position = s->dae->position(s->dae->self, s->section.position_of, &s->at);
    s->t_stop = s->at.t + (n * (double)s->section.period.pitches + 0.5) * pitch;
    const metric_window window = {
        .from = s->at.t, .to = s->t_stop, .mesh = 0, .wheel = -1, .begins = position - floor(position)};
    s->metrics = metrics_create(s->model, &window, taken);
}

/** Shortest orbit after which the motion repeats, or else the one with the smallest distance. */
static int nearest_period(const search *s, int k)
{
    int nearest = 1;
    for (int p = 1; p <= ORBIT_LONGEST && p <= k; p++) {
        if (s->far[k % N_STORED][p] <= s->repeats) {
            return p;
        }
    }
    for (int p = 2; p <= ORBIT_LONGEST && p <= k; p++) {
        nearest = s->far[k % N_STORED][p] < s->far[k % N_STORED][nearest] ? p : nearest;
    }
    return nearest;
}

/** Search a stable orbit of a number of common periods near a state. */
static bool find_orbit(search *s, int k, const state_transfer *here, int periods)
{
    return shortcut_find(&s->section, here, periods, common_time(s, k), s->options, s->interrupt, &s->orbit);
}

/** Search the orbit to which a slowly settling motion converges; once the motion has come much nearer, it can continue
 *  from the orbit. */
static void look_ahead(search *s, int k)
{
    static const double nearer = 0.1;
    if (s->settling.is_on_orbit || !settling_is_slow(&s->settling, common_time(s, k))) {
        return;
    }
    state_transfer here = {.exists = false};
    state_transfer_set(&here, &s->section, &s->at);
    double apart = s->orbit.exists ? state_transfer_distance(&s->orbit, s->model, &here.state) : INFINITY;
    if (k >= s->next_look && !(apart < s->apart)) {
        const int nearest = nearest_period(s, k);
        s->next_look = 2 * k;
        state_transfer_free(&s->orbit);
        if (find_orbit(s, k, &here, 1) ||
            (nearest > 1 && nearest <= LONGEST_LOOK && find_orbit(s, k, &here, nearest))) {
            s->apart = apart = state_transfer_distance(&s->orbit, s->model, &here.state);
        }
    }
    if (s->orbit.exists && (apart <= s->repeats || apart <= nearer * s->apart)) {
        s->stop = STOP_SHORTCUT;
    }
    state_transfer_free(&here);
}

/** Classify a motion that ended without repeating. */
static int judge(search *s, int k, int near)
{
    if (s->result->distance <= s->repeats) {
        return near;
    }
    return settling_goes_on(&s->settling, s->result->periods * common_time(s, k)) ? RESPONSE_SETTLING : 0;
}

/** Process a crossing of the section, at s->at. */
static void on_section(search *s)
{
    const int k = s->n_seen;
    dae_state *now = &s->seen[k % N_STORED];
    dae_state_copy(s->dae, now, &s->at);
    model_take_back(s->model, &s->section.period, k, now);
    s->t_seen[k % N_STORED] = s->at.t;
    for (int p = 1; p <= ORBIT_LONGEST; p++) {
        s->far[k % N_STORED][p] = p <= k ? model_distance(s->model, now, &s->seen[(k - p) % N_STORED]) : NAN;
    }
    s->n_seen++;
    s->result->periods++;
    if (s->metrics != NULL) {
        return;
    }
    if (k > 0) {
        settling_pass(&s->settling, s->result->periods, common_time(s, k), s->far[k % N_STORED]);
        look_ahead(s, k);
    }
    if (s->stop != STOP_NONE) { /* it continues on the orbit: a window from here would have the wrong time */
        return;
    }
    const double length = s->section.period.pitches;
    const bool is_over = s->result->periods >= s->settling.last && k > 0;
    int period = find_period(s, k);
    if (period > 0 || is_over) {
        const int near = period > 0 ? period : nearest_period(s, k);
        s->result->distance = s->far[k % N_STORED][near];
        period = period > 0 ? period : judge(s, k, near);
        s->result->period = period;
        s->result->common_time = (s->at.t - s->t_seen[(k - near) % N_STORED]) / near;
        s->result->time = period > 0 ? s->result->common_time * near : 0;
        open_window(s, period > 0 ? period : ORBIT_WINDOW, s->result->common_time / length);
    }
}

static void on_monitor(void *self, const integrate_step *step)
{
    search *s = self;
    if (!(step->t_to > step->t_from) || s->stop != STOP_NONE) {
        return;
    }
    if (s->metrics != NULL) {
        metrics_monitor(s->metrics, step);
    }
    while (s->stop == STOP_NONE && section_reached(&s->section, step, &s->at)) {
        section_passed(&s->section);
        const bool had_window = s->metrics != NULL;
        on_section(s);
        if (s->metrics != NULL && !had_window) {
            metrics_monitor(s->metrics, step);
        }
    }
    if (s->metrics != NULL &&
        (step->t_to >= s->t_stop || (s->enough > 0 && metrics_span(s->metrics).periods >= s->enough))) {
        s->stop = STOP_DONE;
    }
}

static int on_event(void *self, const event_record *record)
{
    search *s = self;
    section_event(&s->section, record);
    if (s->metrics != NULL) {
        metrics_event(s->metrics, record);
    } else if (section_moves(&s->section)) {
        s->n_seen = 0;
        settling_restart(&s->settling);
        state_transfer_free(&s->orbit);
        s->next_look = FIRST_LOOK;
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

/** Limit of common periods of a motion. @param rate  of pitches, at its start [1/s] */
static int find_most(search *s, int most, double rate)
{
    const model_period *period = &s->section.period;
    const double time = period->by_time ? period->time : period->pitches / rate;
    const settling_times times = settling_of(s->model);
    s->result->time_constant = times.slowest > 0 ? times.slowest : NAN;
    settling_begin(&s->settling, &times, s->repeats, most, period->pitches, time, ORBIT_WINDOW + 2);
    return s->settling.last + ORBIT_WINDOW + 2;
}

/** @return the time limit of the motion [s]; NAN if nothing rotates */
static double time_limit(search *s, int most, const dae_state *state)
{
    static const double slow = 20; /* a motion slower by this factor than at its start counts as stopped */
    const double rate = s->section.period.by_time ? 1 : section_pitch_rate(&s->section, state);
    if (!(rate > 0)) {
        return NAN;
    }
    const double periods = find_most(s, most, rate) + 2.0;
    return state->t + (s->section.period.by_time ? s->section.period.time * periods
                                                 : slow * periods * s->section.period.pitches / rate);
}

/** Continue on the orbit found. */
static bool go_to_orbit(search *s, memory_arena *arena, dae_state *now, char message[DAE_MESSAGE_LENGTH])
{
    const model_period period = s->section.period;
    if (!model_take_over(s->model, s->dae, &s->orbit.state, s->orbit.state.t, now, message)) {
        return false;
    }
    section_begin(&s->section, arena, s->model, &period, s->orbit.phase, now);
    s->n_seen = 0;
    settling_restart(&s->settling);
    s->settling.is_on_orbit = true;
    s->stop = STOP_NONE;
    return true;
}

orbit_end orbit_find(const case_plan *plan, const model_period *period, state_transfer *state, int most,
                     const volatile sig_atomic_t *interrupt, orbit_result *result, double *values,
                     char message[DAE_MESSAGE_LENGTH])
{
    ARENA_SCOPE memory_arena arena = {NULL};
    search *s = arena_calloc(&arena, 1, sizeof *s);
    static const double smallest = 1e-6, times = 1000; /* relative to the tolerance, in the same units */
    *result = (orbit_result){.pitches = period->pitches, .distance = NAN, .time_constant = NAN};
    s->model = plan->model;
    s->dae = &model_about(plan->model)->dae;
    s->repeats = fmax(smallest, times * plan->integration.tolerance);
    s->interrupt = interrupt != NULL ? interrupt : &interrupt_signal;
    s->result = result;
    s->at = dae_state_create(s->dae, &arena);
    for (int i = 0; i < N_STORED; i++) {
        s->seen[i] = dae_state_create(s->dae, &arena);
    }
    dae_state now = dae_state_create(s->dae, &arena);
    dae_state_copy(s->dae, &now, &state->state);
    section_begin(&s->section, &arena, plan->model, period, state->phase, &now);
    const integrate_options options = integrate_options_between(&plan->integration, now.t, time_limit(s, most, &now));
    const integrate_observer observer = {.self = s, .event = on_event, .step = on_step, .monitor = on_monitor};
    integrate_counts counts;
    message[0] = '\0';
    if (isnan(options.t_end)) {
        (void)snprintf(message, DAE_MESSAGE_LENGTH,
                       "the first mesh does not turn in its nominal sense at the start of the motion; start with "
                       "speeds, or from a steady state");
        return ORBIT_FAILED;
    }
    s->options = &options;
    s->next_look = FIRST_LOOK;
    integrate_code code = integrate(s->dae, &options, &observer, &now, &counts, message);
    if (s->stop == STOP_SHORTCUT && go_to_orbit(s, &arena, &now, message)) {
        code = integrate(s->dae, &options, &observer, &now, &counts, message);
    }
    state_transfer_free(&s->orbit);
    orbit_end end = s->stop == STOP_DONE ? ORBIT_FOUND : s->stop == STOP_INTERRUPTED ? ORBIT_INTERRUPTED : ORBIT_FAILED;
    if (end == ORBIT_FAILED && code == INTEGRATE_DONE) {
        (void)snprintf(message, DAE_MESSAGE_LENGTH,
                       "the first mesh passed %.4g pitches in %.4g s, almost at standstill",
                       result->periods * (double)period->pitches, now.t - state->state.t);
    }
    if (end == ORBIT_FOUND) {
        metrics_conclude(s->metrics, values);
        state_transfer_set(state, &s->section, &s->at);
    }
    metrics_delete(&s->metrics);
    return end;
}

/** Whether a run returned to its start after a number of common periods; its final state is shifted back.
 *  @param near  in units of the states; grazing contact may deflect it from its orbit */
static bool has_come_back(search *s, const dae_state *start, int periods, double near)
{
    enum { OMEGA = 1 }; /* skips the angle, which increases */
    if (s->n_seen < periods) {
        return false;
    }
    dae_state *last = &s->seen[(periods - 1) % N_STORED];
    model_take_back(s->model, &s->section.period, 1, last);
    for (int i = OMEGA; i < s->dae->n; i++) {
        if (!(fabs(last->y[i] - start->y[i]) <= near * s->dae->scale[i])) {
            return false;
        }
    }
    return true;
}

orbit_end orbit_record(const case_plan *plan, const model_period *period, const dae_state *state, int periods,
                       double time, bool is_stable, const volatile sig_atomic_t *interrupt, dae_state *round,
                       double *values, char message[DAE_MESSAGE_LENGTH])
{
    /* tolerance: metrics and returns are accurate to 1e-8, and unstable motions depart from their orbit slowly enough */
    const double tight = is_stable ? 1e-9 : 1e-11;
    ARENA_SCOPE memory_arena arena = {NULL};
    search *s = arena_calloc(&arena, 1, sizeof *s);
    orbit_result result = {.period = periods};
    const double pitch = time / period->pitches;
    s->interrupt = interrupt;
    s->model = plan->model;
    s->dae = &model_about(plan->model)->dae;
    s->result = &result;
    s->at = dae_state_create(s->dae, &arena);
    for (int i = 0; i < N_STORED; i++) {
        s->seen[i] = dae_state_create(s->dae, &arena);
    }
    dae_state now = dae_state_create(s->dae, &arena);
    if (!model_take_over(plan->model, s->dae, state, state->t, &now, message)) {
        return ORBIT_FAILED;
    }
    dae_state_copy(s->dae, &s->at, &now);
    section_begin(&s->section, &arena, plan->model, period, SECTION_USUAL_PHASE, &now);
    const double position = section_position(&s->section, &now);
    section_begin(&s->section, &arena, plan->model, period,
                  position - period->pitches * floor(position / period->pitches), &now);
    dae_state began = dae_state_create(s->dae, &arena);
    dae_state_copy(s->dae, &began, &now);
    open_window(s, periods, pitch);
    s->enough = (long)periods * period->pitches;
    integrate_options options = integrate_options_between(&plan->integration, now.t, s->t_stop + pitch);
    options.tolerance = fmin(options.tolerance, tight);
    const integrate_observer observer = {.self = s, .event = on_event, .step = on_step, .monitor = on_monitor};
    integrate_counts counts;
    (void)integrate(s->dae, &options, &observer, &now, &counts, message);
    orbit_end end = s->stop == STOP_DONE ? ORBIT_FOUND : s->stop == STOP_INTERRUPTED ? ORBIT_INTERRUPTED : ORBIT_FAILED;
    if (end == ORBIT_FOUND && !has_come_back(s, &began, periods, round != NULL ? INFINITY : 1e-4)) {
        (void)snprintf(message, DAE_MESSAGE_LENGTH, "a run leaves the orbit: its metrics are omitted");
        end = ORBIT_FAILED;
    }
    if (end == ORBIT_FOUND) {
        metrics_conclude(s->metrics, values);
    }
    if (end == ORBIT_FOUND && round != NULL) {
        const dae_state *last = &s->seen[(periods - 1) % N_STORED];
        round->t = last->t;
        memcpy(round->y, last->y, (size_t)s->dae->n * sizeof *round->y);
        memcpy(round->integers, last->integers, (size_t)s->dae->n_integers * sizeof *round->integers);
        memcpy(round->reals, last->reals, (size_t)s->dae->n_reals * sizeof *round->reals);
    }
    metrics_delete(&s->metrics);
    return end;
}
