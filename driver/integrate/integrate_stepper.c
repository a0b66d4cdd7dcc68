/* A stepper goes as it likes, the grid is interpolated. */
#include "integrate/integration.h"

#include <math.h>
#include <string.h>

static const double longest_step = 0.02; /* of the whole time: longer ones were seen to misjudge a slow start */

static integrate_code redo(void *self)
{
    const integration *run = self;
    run->model->stepper->redo(run->stepper, run->state);
    return INTEGRATE_DONE;
}

/* The grid points that the last step passed; the end itself is handed over at the end. An event that an output shows to have been
 * missed is looked for again in smaller steps. */
static integrate_code give_outputs(integration *run, bool *missed)
{
    *missed = false;
    const dae_stepper *with = run->model->stepper;
    for (;;) {
        const double t_out = integration_output_time(run);
        if (integration_is_later(t_out, run->state->t) || t_out >= run->options->t_end) {
            return INTEGRATE_DONE;
        }
        dae_state state = integration_borrowed(run);
        state.t = t_out;
        (void)with->interpolate(run->stepper, fmin(t_out, run->state->t), state.y);
        const integrate_code code = integration_give_output(run, &state, missed);
        if (code == INTEGRATE_STOPPED) {
            run->state->t = t_out;
            memcpy(run->state->y, state.y, (size_t)run->model->n * sizeof(double));
        }
        if (*missed) {
            (void)redo(run);
        }
        if (code != INTEGRATE_DONE || *missed) {
            return code;
        }
        run->next_output++;
    }
}

/* Let the observer look into the step just made. */
static void watch(void *self)
{
    integration *run = self;
    const double t_before = run->t_unwatched;
    run->t_unwatched = run->state->t;
    if (run->observer->watch == NULL || !(run->state->t > t_before)) {
        return;
    }
    const integrate_step step = {.t_from = t_before,
                                 .t_to = run->state->t,
                                 .state = run->state,
                                 .with = run->stepper,
                                 .interpolate = run->model->stepper->interpolate,
                                 .interpolate_lanes = run->model->stepper->interpolate_lanes,
                                 .look = run->model->stepper->look,
                                 .candidate = run->model->stepper->candidate};
    run->observer->watch(run->observer->self, &step);
}

/* One step, and what happened at its end. */
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
        run->t_unwatched = run->state->t;
        if (m->stepper->advance(run->stepper, t_stop, run->state, run->fired, &outcome, run->reason) != DAE_OK) {
            return INTEGRATE_FAILED;
        }
        bool missed;
        const integrate_code code = give_outputs(run, &missed);
        if (code != INTEGRATE_DONE || missed) {
            return code;
        }
        if (run->state->t < run->options->t_end || outcome == DAE_AT_EVENT) {
            watch(run); /* the end has not proved good yet */
        }
        if (run->observer->step(run->observer->self, run->state->t) != 0) {
            return INTEGRATE_STOPPED;
        }
    }
    const bool time_event = run->state->t >= t_event;
    if (outcome != DAE_AT_EVENT && !time_event) {
        return INTEGRATE_DONE;
    }
    watch(run);
    const integrate_code code = integration_apply_event(run, time_event);
    if (code == INTEGRATE_DONE) {
        m->stepper->restart(run->stepper, run->state);
    }
    return code;
}

integrate_code integrate_by_stepper(integration *run)
{
    static const integration_ways ways = {.advance = advance, .redo = redo, .watch = watch};
    const dae *m = run->model;
    const integrate_options *options = run->options;
    const double max_step = fmin(options->max_step, longest_step * (options->t_end - run->t_start));
    integrate_code code = INTEGRATE_FAILED;
    run->stepper = m->stepper->create(m->self, options->tolerance, max_step, run->reason);
    if (run->stepper == NULL) {
        return code;
    }
    if (m->stepper->start(run->stepper, run->state, run->reason) == DAE_OK) {
        code = integration_to_the_end(run, &ways, run);
        m->stepper->counts(run->stepper, run->counts);
    }
    m->stepper->destroy(run->stepper);
    return code;
}
