/* Motion by steps. The stepper chooses its steps freely and the motion is interpolated, as in a run. As long as no
 * input changes it is identical to that run, for any steps of the caller. After a change of an input the stepper
 * restarts, and its step ends with the caller's. */
#include "motion/motion.h"

#include "integrate/smallest_step.h"
#include "motion/motion_parts.h"

#include <float.h>
#include <math.h>
#include <string.h>

/** Relative rounding error between a prescribed speed and that of the wheel. */
static const double rounding = 1e-12;
/** Largest relative difference that is not a jump: accuracy of an importer's signals. */
static const double noise = 1e-6;

/** Rate of a wheel for which it reaches the prescribed speed at the end of the caller's step. A speed consistent with
 *  its rate differs from the wheel's at most by the change of the rate in a step; a larger difference is a jump. */
static bool follow_speed(motion *m, const motion_input *input, double t, double *rate)
{
    const double h = t - m->now.t, turns = model_wheel_speed(m->plan.model, input->of.wheel, &m->now);
    const double apart = input->value - turns, size = fmax(fabs(input->value), fabs(turns));
    const double most = noise * size + h * (fabs(input->rate) + fabs(input->used));
    if (!(fabs(apart) <= most)) {
        return motion_fail_speed(m, input, turns);
    }
    *rate = fabs(apart) <= rounding * size ? input->rate : input->rate + apart / h;
    return true;
}

/** Set the model's inputs for a step to t. *changes: an input differs from the previous step */
static bool feed_step(motion *m, double t, bool *changes)
{
    *changes = false;
    for (int i = 0; i < m->about.n_inputs; i++) {
        motion_input *input = &m->about.inputs[i];
        double rate = 0;
        if (input->of.is_speed && !follow_speed(m, input, t, &rate)) {
            return false;
        }
        if (input->is_new || !(fabs(rate - input->used) <= rounding * fabs(rate))) {
            *changes = true;
            model_feed(m->plan.model, input->of.load, input->value, rate);
        }
        input->used = rate;
        input->is_new = false;
    }
    return true;
}

/** Restart from the present time, since an input has changed; the stepper's results beyond it are discarded. */
static void go_on_anew(motion *m)
{
    if (m->at_event) {
        m->dae->stepper->redo(m->stepper, &m->reach); /* to discard the event ahead */
    }
    dae_state_copy(m->dae, &m->reach, &m->now);
    m->at_event = m->at_time_event = false;
    m->dae->stepper->restart(m->stepper, &m->reach);
}

static bool apply_pending(motion *m)
{
    const bool time_event = m->at_time_event;
    m->at_event = m->at_time_event = false;
    if (!motion_apply(m, &m->reach, time_event)) {
        return false;
    }
    m->dae->stepper->restart(m->stepper, &m->reach);
    return true;
}

/** Apply an event at the end of the caller's last step, before an input changes there. */
static bool happen_now(motion *m)
{
    if (!(m->at_event || m->at_time_event) || m->reach.t > m->now.t) {
        return true;
    }
    const double t = m->now.t;
    if (!apply_pending(m)) {
        return false;
    }
    dae_state_copy(m->dae, &m->now, &m->reach);
    m->now.t = t;
    return true;
}

/** Make one step, or apply the events at the end of the last one. */
static bool advance(motion *m, double t_stop)
{
    const dae *dae = m->dae;
    if (m->at_event || m->at_time_event) {
        return apply_pending(m);
    }
    const double t_event = dae->next_time_event(dae->self, &m->reach);
    const double t_last = fmin(t_stop, t_event);
    dae_outcome outcome = DAE_AT_STOP;
    memset(m->fired, 0, (size_t)dae->n_roots * sizeof *m->fired);
    if (!integration_is_later(t_last, m->reach.t)) {
        m->reach.t = t_last;
    } else if (dae->stepper->advance(m->stepper, t_last, &m->reach, m->fired, &outcome, m->message) != DAE_OK) {
        return motion_fail(m, m->message);
    }
    m->at_event = outcome == DAE_AT_EVENT;
    m->at_time_event = m->reach.t >= t_event;
    const double grain = progress_rate_resolution(m->reach.t, m->plan.integration.t_end);
    return progress_rate_steps(&m->progress_rate, 1, m->reach.t, grain) ||
           motion_fail(m, "the integrator makes no progress");
}

/** Set the visible state at t, within the last step; if that was to stop at t, as in a run at its end, the step's own
 *  end. */
static void set_visible_state(motion *m, double t, bool stops)
{
    m->now.t = t;
    if (stops && !(m->reach.t > t)) {
        memcpy(m->now.y, m->reach.y, (size_t)m->dae->n * sizeof *m->now.y);
    } else {
        (void)m->dae->stepper->interpolate(m->stepper, fmin(t, m->reach.t), m->now.y);
    }
    memcpy(m->now.integers, m->reach.integers, (size_t)m->dae->n_integers * sizeof *m->now.integers);
    memcpy(m->now.reals, m->reach.reals, (size_t)m->dae->n_reals * sizeof *m->now.reals);
}

/** Whether the outputs at `now` agree with the discrete state: else an event was missed. */
static dae_code look(motion *m)
{
    const int code = model_sampler_at(m->sampler, true, &m->now, m->values, m->message);
    m->has_outputs = code == DAE_OK;
    return (dae_code)code;
}

bool motion_to(motion *m, double t)
{
    enum { MOST_TIMES_MISSED = 12 }; /* each time the step is reduced to a quarter */
    bool changes;
    m->error = (evl_error){EVL_EXIT_OK, "", ""};
    if (!(t > m->now.t)) {
        return true;
    }
    if (!happen_now(m) || !feed_step(m, t, &changes)) {
        return false;
    }
    if (changes) {
        go_on_anew(m);
    }
    const bool stops = changes || t >= m->t_end;
    m->has_outputs = false;
    dae_code code = DAE_RECOVERABLE;
    for (int times = 0; code == DAE_RECOVERABLE && times <= MOST_TIMES_MISSED; times++) {
        if (times > 0) {
            m->dae->stepper->redo(m->stepper, &m->reach);
            m->at_event = m->at_time_event = false;
        }
        while (m->reach.t < t) {
            if (!advance(m, stops ? t : m->t_end)) {
                return false;
            }
        }
        set_visible_state(m, t, stops);
        code = look(m);
    }
    return code == DAE_OK || motion_fail(m, m->message);
}
