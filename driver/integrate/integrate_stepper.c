/* A stepper chooses its steps freely; outputs are interpolated. */
#include "integrate/integration.h"
#include "integrate/smallest_step.h"

#include <math.h>
#include <string.h>

static integrate_code redo(void *self)
{
    const integration *run = self;
    run->model->stepper->redo(run->stepper, run->state);
    return INTEGRATE_DONE;
}

/* The step since the last one seen by the observer. */
static integrate_step last_step(const integration *run)
{
    return (integrate_step){.t_from = run->t_unmonitored,
                            .t_to = run->state->t,
                            .state = run->state,
                            .with = run->stepper,
                            .interpolate = run->model->stepper->interpolate,
                            .interpolate_some = run->model->stepper->interpolate_some,
                            .interpolate_lanes = run->model->stepper->interpolate_lanes,
                            .look = run->model->stepper->look,
                            .candidate = run->model->stepper->candidate};
}

/* States of the last step at several times, for each state variable the values at the times. */
static void find_states(integration *run, const integrate_step *step, int n, double t[DAE_LANES])
{
    enum { FEW = 1 }; /* faster one by one */
    const int n_states = run->model->n;
    for (int k = 0; k < DAE_LANES; k++) {
        t[k] = t[k] < run->state->t ? t[k] : run->state->t;
    }
    if (n > FEW) {
        step->interpolate_lanes(step->with, t, run->lanes);
        return;
    }
    for (int k = 0; k < n; k++) {
        (void)step->interpolate(step->with, t[k], run->trial.y);
        for (int i = 0; i < n_states; i++) {
            run->lanes[i * DAE_LANES + k] = run->trial.y[i];
        }
    }
}

/* Pass the grid points of the last step to an observer that accepts several. */
static integrate_code give_several(integration *run)
{
    const integrate_step step = last_step(run);
    double due[DAE_LANES], t[DAE_LANES];
    int n = 0;
    while ((n = output_grid_ahead(&run->grid, &step, run->observer->capacity(run->observer->self), due)) > 0) {
        memcpy(t, due, sizeof t);
        find_states(run, &step, n, t);
        if (run->observer->several(run->observer->self, n, due, run->lanes, run->state, run->reason) != 0) {
            return INTEGRATE_STOPPED;
        }
        run->grid.next += n;
    }
    return INTEGRATE_DONE;
}

/* Pass on the grid points in the last step; the end is passed on last. If an output shows that an event was missed, it
 * is searched again in smaller steps. */
static integrate_code give_outputs(integration *run, bool *missed)
{
    *missed = false;
    if (run->observer->several != NULL && !output_grid_goes_by_position(&run->grid)) {
        return give_several(run);
    }
    const integrate_step step = last_step(run);
    dae_state state = integration_borrowed(run);
    output_due due;
    while (output_grid_due(&run->grid, &step, &state, &due)) {
        state.t = due.t;
        (void)step.interpolate(step.with, fmin(due.t, run->state->t), state.y);
        const integrate_code code = integration_give_output(run, &state, &due, missed);
        if (code == INTEGRATE_STOPPED) {
            run->state->t = due.t;
            memcpy(run->state->y, state.y, (size_t)run->model->n * sizeof(double));
        }
        if (*missed) {
            (void)redo(run);
        }
        if (code != INTEGRATE_DONE || *missed) {
            return code;
        }
    }
    return INTEGRATE_DONE;
}

/* Let the observer process the last step. */
static void monitor_step(integration *run, bool goes_on)
{
    integrate_step step = last_step(run);
    step.goes_on = goes_on;
    run->t_unmonitored = run->state->t;
    if (run->observer->monitor != NULL && step.t_to > step.t_from) {
        run->observer->monitor(run->observer->self, &step);
    }
}

static void monitor(void *self)
{
    monitor_step(self, false);
}

/* Make one step, and apply the events at its end. */
static integrate_code advance(void *self)
{
    integration *run = self;
    const dae *m = run->model;
    const double t_event = m->next_time_event(m->self, run->state);
    const double t_stop = fmin(run->options->t_end, t_event);
    dae_outcome outcome = DAE_AT_STOP;
    if (!integration_is_later(t_stop, run->state->t)) {
        run->state->t = t_stop;
        memset(run->fired, 0, (size_t)m->n_roots * sizeof *run->fired);
    } else {
        run->t_unmonitored = run->state->t;
        if (m->stepper->advance(run->stepper, t_stop, run->state, run->fired, &outcome, run->reason) != DAE_OK) {
            return INTEGRATE_FAILED;
        }
        bool missed;
        const integrate_code code = give_outputs(run, &missed);
        if (code != INTEGRATE_DONE || missed) {
            return code;
        }
        if (run->state->t < run->options->t_end || outcome == DAE_AT_EVENT) {
            monitor_step(run, outcome == DAE_STEPPED && run->state->t < t_event); /* the end is not verified yet */
        }
        if (run->observer->step(run->observer->self, run->state->t) != 0) {
            return INTEGRATE_STOPPED;
        }
    }
    const bool time_event = run->state->t >= t_event;
    if (outcome != DAE_AT_EVENT && !time_event) {
        return INTEGRATE_DONE;
    }
    monitor(run);
    const integrate_code code = integration_apply_event(run, time_event);
    if (code == INTEGRATE_DONE) {
        m->stepper->restart(run->stepper, run->state);
    }
    return code;
}

integrate_code integrate_by_stepper(integration *run)
{
    static const integration_scheme scheme = {.advance = advance, .redo = redo, .monitor = monitor};
    const dae *m = run->model;
    const integrate_options *options = run->options;
    integrate_code code = INTEGRATE_FAILED;
    run->stepper = m->stepper->create(m->self, options->tolerance, options->max_step, run->reason);
    if (run->stepper == NULL) {
        return code;
    }
    const bool has_begun = run->observer->resume != NULL
                               ? integration_serialize(run, run->observer->resume)
                               : m->stepper->start(run->stepper, run->state, run->reason) == DAE_OK;
    if (has_begun) {
        code = integration_to_the_end(run, &scheme, run);
        m->stepper->counts(run->stepper, run->counts);
    }
    m->stepper->destroy(run->stepper);
    return code;
}
