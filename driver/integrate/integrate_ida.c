/* IDA chooses its steps freely and interpolates; it restarts after an event. */
#include "integrate/integration.h"
#include "integrate/smallest_step.h"

#include "integrate/ida_session.h"
#include "integrate/integrate.h"

#include <ida/ida.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sundials/sundials_config.h>

/* A contact of damping ratio 0.02 is integrated for thousands of oscillations: a Newton matrix outdated by more than 1
 * % in the step size costs more steps than it saves factorisations. */
static const double matrix_staleness = 0.01;
static const double first_step = 1e-8;   /* [s] from flanks in contact, where the force's stiffness starts from 0 */
static const double restart_step = 1e-7; /* [s] after an event */
static const double shortest_run = 1e-3; /* [s] for shorter runs both are reduced */
static const long steps_between_looks = 1000; /* after which the observer is called, regardless of the next output */

/* First step, reduced for a short run. */
static double step_of(const integration *run, double step)
{
    return step * fmin(1, run->options->t_end / shortest_run);
}

static bool set_up(ida_session *s, double step)
{
    const dae *m = s->run->model;
    ida_session_to_scaled(s, s->run->state->y, s->y);
    ida_session_to_scaled(s, s->run->state->yp, s->yp);
    bool good = IDAInit(s->ida, ida_residual, s->run->state->t, s->y, s->yp) == IDA_SUCCESS;
    good = good && IDAWFtolerances(s->ida, ida_weights) == IDA_SUCCESS;
    good = good && IDASetUserData(s->ida, s) == IDA_SUCCESS;
    good = good && IDASetLinearSolver(s->ida, s->solver, s->matrix) == IDA_SUCCESS;
    good = good && IDASetJacFn(s->ida, ida_jacobian) == IDA_SUCCESS;
    good = good && IDASetDeltaCjLSetup(s->ida, matrix_staleness) == IDA_SUCCESS;
    good = good && IDASetMaxNumSteps(s->ida, steps_between_looks) == IDA_SUCCESS;
    good = good && IDASetMaxStep(s->ida, s->run->options->max_step) == IDA_SUCCESS;
    good = good && IDASetInitStep(s->ida, step) == IDA_SUCCESS;
    if (good && m->n_roots > 0) {
        m->root_directions(m->self, s->run->state->integers, s->directions);
        good = IDARootInit(s->ida, m->n_roots, ida_roots) == IDA_SUCCESS &&
               IDASetRootDirection(s->ida, s->directions) == IDA_SUCCESS &&
               IDASetNoInactiveRootWarn(s->ida) == IDA_SUCCESS;
    }
    return good;
}

/* Report the model's message if it refused states at or beyond the last accepted one, else the integrator's. */
static integrate_code explain(ida_session *s, int flag)
{
    if (s->t_refused < s->run->state->t) {
        char *name = IDAGetReturnFlagName(flag);
        double step = 0;
        (void)IDAGetCurrentStep(s->ida, &step);
        (void)snprintf(s->run->reason, DAE_MESSAGE_LENGTH,
                       "the integrator cannot continue (%s): its step fell to %.3g s without reducing the error; try a "
                       "larger tolerance than %g%s",
                       name ? name : "unknown reason", step, s->run->options->tolerance,
                       s->run->model->stepper != NULL ? ", or integrator radau" : "");
        free(name);
    }
    return INTEGRATE_FAILED;
}

/* Restart from the present state, in units of the scales. */
static integrate_code start_anew(ida_session *s, double step)
{
    ida_session_count(s);
    s->before = *s->run->counts;
    s->t_monitored = s->run->state->t;
    s->t_channels = NAN; /* values of the earlier motion */
    s->nodes->t[IDA_NODES - 1] = NAN;
    memset(s->cached, 0, (size_t)s->run->model->n_cached * sizeof(double));
    s->continues = false;
    if (IDAReInit(s->ida, s->run->state->t, s->y, s->yp) != IDA_SUCCESS ||
        IDASetInitStep(s->ida, step) != IDA_SUCCESS) {
        (void)snprintf(s->run->reason, DAE_MESSAGE_LENGTH, "the integrator could not be restarted");
        return INTEGRATE_FAILED;
    }
    return INTEGRATE_DONE;
}

/* An event in the last step was missed: restart at its start, with a fraction of its size. */
static integrate_code take_back(void *self)
{
    ida_session *s = self;
    double t = 0, step = 0;
    bool good = IDAGetCurrentTime(s->ida, &t) == IDA_SUCCESS && IDAGetLastStep(s->ida, &step) == IDA_SUCCESS;
    t -= step;
    good = good && IDAGetDky(s->ida, t, 0, s->y) == IDA_SUCCESS && IDAGetDky(s->ida, t, 1, s->yp) == IDA_SUCCESS;
    if (!good) {
        return INTEGRATE_FAILED; /* the reason is that of the missed event */
    }
    s->run->state->t = t;
    ida_session_from_scaled(s, s->y, s->run->state->y);
    ida_session_from_scaled(s, s->yp, s->run->state->yp);
    return start_anew(s, step / 4);
}

/* The state at an output: the present one, or for outputs by position an interpolated one in the last step. */
static const dae_state *state_of(const ida_session *s, const output_due *due, dae_state *between)
{
    if (!due->has_mark || due->t >= s->run->state->t) {
        return s->run->state;
    }
    between->t = due->t;
    (void)ida_interpolate(s, due->t, between->y);
    return between;
}

/* Pass on the outputs from t_from to the present time, except the end, which is passed on last. *missed: an event in
 * the last step was missed; the integration continues from the start of that step. */
static integrate_code give_outputs(ida_session *s, double t_from, bool *missed)
{
    integration *run = s->run;
    const integrate_step step = {.t_from = t_from,
                                 .t_to = run->state->t,
                                 .continues = s->continues,
                                 .state = run->state,
                                 .with = s,
                                 .interpolate = ida_interpolate};
    dae_state between = integration_borrowed(run);
    output_due due;
    integrate_code code = INTEGRATE_DONE;
    *missed = false;
    while (code == INTEGRATE_DONE && !*missed && output_grid_due(&run->grid, &step, &between, &due)) {
        code = integration_give_output(run, state_of(s, &due, &between), &due, missed);
    }
    if (*missed) {
        const integrate_code taken = take_back(s);
        code = code == INTEGRATE_DONE ? taken : code;
    }
    return code;
}

/* Integrate to t_stop, the next event, or the next possible output: by time the next output; by position any step. */
static int solve(ida_session *s, double t_stop)
{
    integration *run = s->run;
    int flag = IDASetStopTime(s->ida, t_stop);
    if (flag == IDA_SUCCESS) {
        flag = IDASetMinStep(s->ida, integration_smallest_step(fmax(run->state->t, step_of(run, first_step))));
    }
    if (flag == IDA_SUCCESS) {
        const bool one_step = output_grid_goes_by_position(&run->grid);
        flag = IDASolve(s->ida, one_step ? t_stop : output_grid_next(&run->grid), &run->state->t, s->y, s->yp,
                        one_step ? IDA_ONE_STEP : IDA_NORMAL);
    }
    ida_session_from_scaled(s, s->y, run->state->y);
    ida_session_from_scaled(s, s->yp, run->state->yp);
    return flag;
}

/* Apply the events at the present state and restart from there. */
static integrate_code handle_event(ida_session *s, bool time_event)
{
    const dae *m = s->run->model;
    const integrate_code code = integration_apply_event(s->run, time_event);
    if (code != INTEGRATE_DONE) {
        return code;
    }
    ida_session_to_scaled(s, s->run->state->y, s->y);
    ida_session_to_scaled(s, s->run->state->yp, s->yp);
    ida_rounding_forget(&s->rounding);
    m->root_directions(m->self, s->run->state->integers, s->directions);
    if (m->n_roots > 0 && IDASetRootDirection(s->ida, s->directions) != IDA_SUCCESS) {
        return explain(s, IDA_ILL_INPUT);
    }
    return start_anew(s, step_of(s->run, restart_step));
}

/* Advance to the next grid point (by position: step), event or end, whichever comes first; IDA chooses its steps freely
 * and interpolates. */
static integrate_code advance(void *self)
{
    ida_session *s = self;
    const dae *m = s->run->model;
    const double t_event = m->next_time_event(m->self, s->run->state);
    const double t_stop = fmin(s->run->options->t_end, t_event);
    int flag = IDA_TSTOP_RETURN;
    if (!integration_is_later(t_stop, s->run->state->t)) {
        s->run->state->t = t_stop;
    } else {
        const double t_from = s->run->state->t;
        flag = solve(s, t_stop);
        if (flag < 0 && flag != IDA_TOO_MUCH_WORK) {
            return explain(s, flag);
        }
        bool missed;
        const integrate_code code = give_outputs(s, t_from, &missed);
        if (code != INTEGRATE_DONE || missed) {
            return code;
        }
        if (s->run->observer->step(s->run->observer->self, s->run->state->t) != 0) {
            return INTEGRATE_STOPPED;
        }
    }
    const bool root = flag == IDA_ROOT_RETURN;
    const bool time_event = s->run->state->t >= t_event;
    if (!root && !time_event) {
        return INTEGRATE_DONE;
    }
    ida_monitor_to(s, s->run->state->t, s->y);
    memset(s->run->fired, 0, (size_t)m->n_roots * sizeof(int));
    if (root && IDAGetRootInfo(s->ida, s->run->fired) != IDA_SUCCESS) {
        return explain(s, IDA_RTFUNC_FAIL);
    }
    return handle_event(s, time_event);
}

static void monitor(void *self)
{
    ida_session *s = self;
    ida_monitor_to(s, s->run->state->t, s->y);
}

/* Open a session from the present state. */
static integrate_code open_session(ida_session *s, integration *run, double step)
{
    *s = (ida_session){
        .run = run, .before = *run->counts, .t_refused = -INFINITY, .t_monitored = run->state->t, .t_channels = NAN};
    if (!ida_session_open(s)) {
        (void)snprintf(run->reason, DAE_MESSAGE_LENGTH, "there is not enough memory for the integrator");
        return INTEGRATE_FAILED;
    }
    if (!set_up(s, step)) {
        (void)snprintf(run->reason, DAE_MESSAGE_LENGTH, "the integrator rejected its options");
        return INTEGRATE_FAILED;
    }
    return INTEGRATE_DONE;
}

/* IDA's internal memory cannot be serialised: it is discarded, and the run restarts from the present state, both here
 * and when it is resumed. */
static integrate_code settle(void *self)
{
    ida_session *s = self;
    integration *run = s->run;
    ida_monitor_to(s, run->state->t, s->y);
    ida_session_count(s);
    ida_session_close(s);
    return open_session(s, run, step_of(run, restart_step));
}

static long steps(const void *self)
{
    const ida_session *s = self;
    long since_restart = 0;
    (void)IDAGetNumSteps(s->ida, &since_restart);
    return s->before.steps + since_restart;
}

integrate_code integrate_by_ida(integration *run)
{
    static const integration_scheme scheme = {
        .advance = advance, .redo = take_back, .monitor = monitor, .settle = settle, .steps = steps};
    ida_session s = {.run = run};
    const bool resumes = run->observer->resume != NULL;
    integrate_code code = INTEGRATE_FAILED;
    if (!resumes || integration_serialize(run, run->observer->resume)) {
        code = open_session(&s, run, step_of(run, resumes ? restart_step : first_step));
    }
    if (code == INTEGRATE_DONE) {
        code = integration_to_the_end(run, &scheme, &s);
        ida_session_count(&s);
    }
    ida_session_close(&s);
    return code;
}

const char *integrate_version(void)
{
    return "SUNDIALS " SUNDIALS_VERSION " " IDA_SPARSE_VERSION;
}
