#include "integrate/integration.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

static const int most_times_missed = 12; /* missed events at one output: each time the step is reduced to a quarter */

dae_state dae_state_create(const dae *dae, memory_arena *arena)
{
    return (dae_state){.y = arena_calloc(arena, (size_t)dae->n, sizeof(double)),
                       .yp = arena_calloc(arena, (size_t)dae->n, sizeof(double)),
                       .integers = arena_calloc(arena, (size_t)dae->n_integers, sizeof(int)),
                       .reals = arena_calloc(arena, (size_t)dae->n_reals, sizeof(double))};
}

void dae_state_free(dae_state *state)
{
    free(state->y);
    free(state->yp);
    free(state->integers);
    free(state->reals);
    *state = (dae_state){0};
}

void dae_state_copy(const dae *m, dae_state *to, const dae_state *from)
{
    to->t = from->t;
    memcpy(to->y, from->y, (size_t)m->n * sizeof(double));
    memcpy(to->yp, from->yp, (size_t)m->n * sizeof(double));
    memcpy(to->integers, from->integers, (size_t)m->n_integers * sizeof(int));
    memcpy(to->reals, from->reals, (size_t)m->n_reals * sizeof(double));
}

void integration_begin(integration *run)
{
    run->fired = arena_calloc(&run->arena, (size_t)run->model->n_roots, sizeof *run->fired);
    run->events = arena_calloc(&run->arena, (size_t)run->model->n_events, sizeof *run->events);
    run->lanes = arena_calloc(&run->arena, (size_t)run->model->n * DAE_LANES, sizeof *run->lanes);
    run->trial = dae_state_create(run->model, &run->arena);
    run->old = dae_state_create(run->model, &run->arena);
    output_grid_begin(&run->grid, run->model, run->options, run->state);
}

dae_state integration_borrowed(const integration *run)
{
    dae_state state = run->trial;
    state.integers = run->state->integers;
    state.reals = run->state->reals;
    return state;
}

static double grain_of(const integration *run)
{
    return progress_rate_resolution(run->state->t, run->options->t_end);
}

/* Report an event that repeats endlessly, if the model describes it. */
static bool report_endless(integration *run, const char *how)
{
    const dae *m = run->model;
    return m->endless != NULL && run->progress_rate.n_recent > 0 &&
           m->endless(m->self, &run->progress_rate.last, how, run->reason);
}

/* Report events without progress. */
static integrate_code report_events(integration *run)
{
    char how[64];
    (void)snprintf(how, sizeof how, "%d events within %.3g s", run->progress_rate.events - 1,
                   run->state->t - run->progress_rate.t_began);
    if (!report_endless(run, how)) {
        (void)snprintf(run->reason, DAE_MESSAGE_LENGTH, "%s: the model chatters", how);
    }
    return INTEGRATE_FAILED;
}

integrate_code integration_give_output(integration *run, const dae_state *state, const output_due *due, bool *missed)
{
    const integrate_observer *observer = run->observer;
    const bool has_mark = output_grid_goes_by_position(&run->grid);
    output_mark mark = {0};
    if (has_mark) {
        mark = due == NULL ? output_grid_mark(run->model, run->options, state) : due->mark;
    }
    const int code =
        observer->output == NULL ? 0 : observer->output(observer->self, state, has_mark ? &mark : NULL, run->reason);
    *missed = code == INTEGRATE_ANEW;
    if (code == 0) {
        run->reason[0] = '\0';
        if (due != NULL) {
            output_grid_advance(&run->grid, due);
        }
    }
    if (!*missed) {
        return code == 0 ? INTEGRATE_DONE : INTEGRATE_STOPPED;
    }
    run->times_missed = state->t > run->t_missed ? 1 : run->times_missed + 1;
    run->t_missed = fmax(state->t, run->t_missed);
    if (run->times_missed <= most_times_missed) {
        return INTEGRATE_DONE;
    }
    double within = 0;
    if (progress_rate_accumulates(&run->progress_rate, &within)) {
        char how[64];
        (void)snprintf(how, sizeof how, "the last %d of them within %.3g s, at decreasing intervals",
                       PROGRESS_RATE_RECENT, within);
        (void)report_endless(run, how);
    }
    return INTEGRATE_FAILED;
}

static bool know_nothing(const void *with, double t, double *y)
{
    (void)with, (void)t, (void)y;
    return false;
}

void integration_monitor_state(const integration *run)
{
    if (run->observer->monitor != NULL) {
        const integrate_step step = {
            .t_from = run->state->t, .t_to = run->state->t, .state = run->state, .interpolate = know_nothing};
        run->observer->monitor(run->observer->self, &step);
    }
}

integrate_code integration_apply_event(integration *run, bool time_event)
{
    const dae *m = run->model;
    int n_events = 0;
    if (!progress_rate_event(&run->progress_rate, run->state->t, grain_of(run))) {
        return report_events(run);
    }
    if (run->observer->change != NULL && run->observer->change(run->observer->self) != 0) {
        return INTEGRATE_STOPPED;
    }
    dae_state_copy(m, &run->old, run->state);
    if (m->apply_event(m->self, run->state, run->fired, time_event, run->events, &n_events, run->reason) != DAE_OK) {
        dae_state_copy(m, run->state, &run->old);
        return INTEGRATE_FAILED;
    }
    if (n_events > 0) {
        progress_rate_note(&run->progress_rate, run->state->t, &run->events[0]);
    }
    for (int i = 0; i < n_events; i++) {
        const event_record record = {run->state->t, run->events[i], m->n, &run->old, run->state};
        run->counts->events++;
        if (run->observer->event != NULL && run->observer->event(run->observer->self, &record) != 0) {
            return INTEGRATE_STOPPED;
        }
    }
    return INTEGRATE_DONE;
}

double integration_cpu_now(void)
{
    struct timespec now;
    return clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now) == 0 ? (double)now.tv_sec + 1e-9 * (double)now.tv_nsec : 0;
}

bool integration_serialize(integration *run, archive *archive)
{
    SERIALIZE(archive, run->state->t);
    SERIALIZE_ARRAY(archive, run->state->y, run->model->n);
    SERIALIZE_ARRAY(archive, run->state->yp, run->model->n);
    SERIALIZE_ARRAY(archive, run->state->integers, run->model->n_integers);
    SERIALIZE_ARRAY(archive, run->state->reals, run->model->n_reals);
    run->counts->cpu_seconds = integration_cpu_now() - run->cpu_start;
    SERIALIZE(archive, *run->counts);
    run->cpu_start = integration_cpu_now() - run->counts->cpu_seconds;
    SERIALIZE(archive, run->t_start);
    output_grid_serialize(&run->grid, archive);
    progress_rate_serialize(&run->progress_rate, archive);
    SERIALIZE(archive, run->t_unmonitored);
    SERIALIZE(archive, run->t_missed);
    SERIALIZE(archive, run->times_missed);
    SERIALIZE(archive, run->t_rest);
    if (run->stepper != NULL) {
        run->model->stepper->serialize(run->stepper, archive);
    }
    if (run->observer->serialize != NULL) {
        run->observer->serialize(run->observer->self, archive);
    }
    const bool good = archive->is_reading ? archive_is_read(archive) : !archive->has_failed;
    if (!good && archive->is_reading) {
        (void)snprintf(run->reason, DAE_MESSAGE_LENGTH, "the stored state does not belong to this case and program");
    }
    return good;
}

/** Seconds as a text such as "3 h". */
static const char *time_in_words(double seconds, char words[32])
{
    static const struct {
        double seconds;
        const char *name;
    } units[] = {{3.15576e7, "years"}, {86400, "days"}, {3600, "h"}, {60, "min"}, {0, "s"}};
    int i = 0;
    while (seconds < 2 * units[i].seconds) {
        i++;
    }
    (void)snprintf(words, 32, "%.2g %s", seconds / (units[i].seconds > 0 ? units[i].seconds : 1), units[i].name);
    return words;
}

/** Report that the step limit is reached. @param came  progress [s] */
static void report_step_limit(integration *run, bool creeps, double came)
{
    const progress_rate *progress_rate = &run->progress_rate;
    const double steps = creeps ? progress_rate->crept : progress_rate->all;
    const double steps_left = steps * (run->options->t_end - run->state->t) / came;
    const double cpu_of_one = (integration_cpu_now() - run->cpu_start) / progress_rate->all;
    char cpu[32], how[96], needs[96] = "";
    if (creeps) {
        (void)snprintf(how, sizeof how, "the run makes too little progress: its last %.10g steps advanced it by %.3g s",
                       steps, came);
    } else {
        (void)snprintf(how, sizeof how, "the run is not complete after %.10g steps", steps);
    }
    if (steps_left < HUGE_VAL) {
        (void)snprintf(needs, sizeof needs, "; at this rate it requires %.2g more, %s of CPU", steps_left,
                       time_in_words(steps_left * cpu_of_one, cpu));
    }
    (void)snprintf(run->reason, DAE_MESSAGE_LENGTH,
                   "%s%s; increase simulation.max_steps, or choose a larger tolerance or a shorter duration", how,
                   needs);
}

/** Write a checkpoint, always at the end of a step. */
static integrate_code put_away(integration *run, const integration_scheme *scheme, void *self)
{
    const integrate_observer *observer = run->observer;
    const integrate_code code = scheme->settle == NULL ? INTEGRATE_DONE : scheme->settle(self);
    if (code != INTEGRATE_DONE) {
        return code;
    }
    archive archive = {0};
    const bool goes_on = integration_serialize(run, &archive) &&
                         observer->write_checkpoint(observer->self, run->state->t, &archive) == 0;
    archive_free(&archive);
    return goes_on ? INTEGRATE_DONE : INTEGRATE_STOPPED;
}

/** Count n steps and check the step limit. */
static integrate_code spend(integration *run, int n, const integration_scheme *scheme, void *self)
{
    const integrate_options *options = run->options;
    const double t = run->state->t, t_before = run->progress_rate.t_crept;
    const step_budget left = progress_rate_spend(&run->progress_rate, n, t, options->t_end,
                                                 options->most_steps > 0 ? options->most_steps : DBL_MAX);
    if (left == BUDGET_FITS || !(t < options->t_end)) {
        return INTEGRATE_DONE;
    }
    if (run->observer->checkpoint_at_limit) {
        (void)run->observer->is_due(run->observer->self, t); /* always due; the call informs the observer of the time */
        const integrate_code code = put_away(run, scheme, self);
        if (code != INTEGRATE_DONE) {
            return code;
        }
    }
    report_step_limit(run, left == BUDGET_TOO_SLOW, t - (left == BUDGET_TOO_SLOW ? t_before : run->t_start));
    return INTEGRATE_SPENT;
}

/** Write a checkpoint if due, once for each time, so that the time identifies it. */
static integrate_code rest(integration *run, const integration_scheme *scheme, void *self)
{
    const integrate_observer *observer = run->observer;
    if (observer->is_due == NULL || !(run->state->t > run->t_rest)) {
        return INTEGRATE_DONE;
    }
    run->t_rest = run->state->t;
    return observer->is_due(observer->self, run->state->t) ? put_away(run, scheme, self) : INTEGRATE_DONE;
}

integrate_code integration_to_the_end(integration *run, const integration_scheme *scheme, void *self)
{
    bool missed = false;
    long seen = scheme->steps == NULL ? 0 : scheme->steps(self);
    integrate_code code =
        run->observer->resume != NULL ? INTEGRATE_DONE : integration_give_output(run, run->state, NULL, &missed);
    if (missed) {
        return INTEGRATE_FAILED;
    }
    do {
        while (code == INTEGRATE_DONE && run->state->t < run->options->t_end) {
            code = rest(run, scheme, self);
            code = code == INTEGRATE_DONE ? scheme->advance(self) : code;
            const long now = scheme->steps == NULL ? seen + 1 : scheme->steps(self);
            const int n = (int)(now - seen);
            seen = now;
            code = code == INTEGRATE_DONE ? spend(run, n, scheme, self) : code;
            if (code == INTEGRATE_DONE && !progress_rate_steps(&run->progress_rate, n, run->state->t, grain_of(run))) {
                (void)snprintf(run->reason, DAE_MESSAGE_LENGTH,
                               "the integrator makes no progress: %d steps within %.3g s", run->progress_rate.steps,
                               run->state->t - run->progress_rate.t_began);
                code = INTEGRATE_FAILED;
            }
        }
        if (code == INTEGRATE_DONE) {
            code = integration_give_output(run, run->state, NULL, &missed);
        }
        if (missed) {
            const integrate_code taken = scheme->redo(self);
            code = code == INTEGRATE_DONE ? taken : code;
        }
    } while (code == INTEGRATE_DONE && missed);
    if (code != INTEGRATE_FAILED && code != INTEGRATE_SPENT) {
        scheme->monitor(self);
        integration_monitor_state(run);
    }
    return code;
}
