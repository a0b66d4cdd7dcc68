/* The only file beside short_vectors that includes SUNDIALS. States are handed to IDA in units of their scales, so that one
 * absolute tolerance holds for all of them. Differences between SUNDIALS 6 and 7 stay here. */
#include "integrate/integration.h"

#include "integrate/short_vectors.h"

#include <ida/ida.h>
#include <math.h>
#include <nvector/nvector_serial.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sundials/sundials_config.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_dense.h>

#if SUNDIALS_VERSION_MAJOR < 7
#define SUN_COMM_NULL NULL
#endif

/* A contact of damping ratio 0.02 is followed for thousands of oscillations: a Newton matrix that is out of date by more than a
 * hundredth in the step size costs more steps than it saves factorisations. */
static const double matrix_staleness = 0.01;
static const double first_step = 1e-8;   /* [s] from touching flanks, where the force's stiffness starts from 0 */
static const double restart_step = 1e-7; /* [s] after an event */
/* Only for what grows beyond all scales, such as the gap of flanks that never meet again: asks for no more than rounding allows. */
static const double relative_tolerance = 16 * DBL_EPSILON;
static const long steps_between_looks = 1000; /* after which the observer hears of it, however far the next output is */

typedef struct {
    integration *run;        /* the states in it are in physical units */
    integrate_counts before; /* until the last restart: IDAReInit starts its counters anew */
    double *row_units;       /* 1/row_scale */
    int *directions;
    SUNContext context;
    void *ida;
    N_Vector y, yp, id;
    N_Vector between;  /* state inside a step, for who watches */
    double *watched_y; /* [n] */
    double t_watched;  /* up to which the observer has seen the motion */
    double *channels;  /* [n_watched] watched channels where the roots were asked last */
    double t_channels; /* when that was */
    bool continues;    /* nothing happened there */
    SUNMatrix matrix;
    SUNLinearSolver solver;
    double t_refused; /* latest time at which the model had no answer */
} session;

/* The discrete state cannot change while IDA steps: trial states borrow the caller's. */
static void take_trial(session *s, double t, N_Vector y, N_Vector yp)
{
    const double *scale = s->run->model->scale;
    const double *from = N_VGetArrayPointer(y);
    s->run->trial.t = t;
    for (int i = 0; i < s->run->model->n; i++)
        s->run->trial.y[i] = from[i] * scale[i];
    if (!yp)
        return;
    const double *rates = N_VGetArrayPointer(yp);
    for (int i = 0; i < s->run->model->n; i++)
        s->run->trial.yp[i] = rates[i] * scale[i];
}

static void note_refusal(session *s, int code)
{
    if (code != DAE_OK) {
        s->t_refused = s->run->trial.t;
    }
}

static int residual(sunrealtype t, N_Vector y, N_Vector yp, N_Vector r, void *data)
{
    session *s = data;
    take_trial(s, t, y, yp);
    const dae_state state = integration_borrowed(s->run);
    double *rows = N_VGetArrayPointer(r);
    const int code = s->run->model->residual(s->run->model->self, &state, rows, s->run->reason);
    note_refusal(s, code);
    for (int i = 0; i < s->run->model->n; i++)
        rows[i] *= s->row_units[i];
    return code;
}

static int jacobian(sunrealtype t, sunrealtype cj, N_Vector y, N_Vector yp, N_Vector r, SUNMatrix matrix, void *data,
                    N_Vector a, N_Vector b, N_Vector c)
{
    (void)r, (void)a, (void)b, (void)c;
    session *s = data;
    const int n = s->run->model->n;
    take_trial(s, t, y, yp);
    const dae_state state = integration_borrowed(s->run);
    double *entries = SUNDenseMatrix_Data(matrix);
    const int code = s->run->model->jacobian(s->run->model->self, &state, cj, entries, s->run->reason);
    note_refusal(s, code);
    for (int j = 0; j < n; j++)
        for (int i = 0; i < n; i++)
            entries[j * n + i] *= s->row_units[i] * s->run->model->scale[j];
    return code;
}

static int roots(sunrealtype t, N_Vector y, N_Vector yp, sunrealtype *values, void *data)
{
    session *s = data;
    take_trial(s, t, y, yp);
    const dae_state state = integration_borrowed(s->run);
    const dae *m = s->run->model;
    const bool watches = s->run->observer->watch != NULL;
    const int code = watches ? m->roots_and_watched(m->self, &state, values, s->channels, s->run->reason)
                             : m->roots(m->self, &state, values, s->run->reason);
    s->t_channels = watches && code == DAE_OK ? t : NAN;
    note_refusal(s, code);
    return code;
}

static void from_scaled(const session *s, N_Vector from, double *to)
{
    const double *values = N_VGetArrayPointer(from);
    for (int i = 0; i < s->run->model->n; i++) {
        to[i] = values[i] * s->run->model->scale[i];
    }
}

static bool interpolate(const void *with, double t, double *y)
{
    const session *s = with;
    if (IDAGetDky(s->ida, t, 0, s->between) != IDA_SUCCESS) {
        return false;
    }
    from_scaled(s, s->between, y);
    return true;
}

/* Let the observer look at the motion from where it has seen it to t, in the last step. */
static void watch_to(session *s, double t, N_Vector y)
{
    if (s->run->observer->watch == NULL || !(t > s->t_watched)) {
        return;
    }
    const bool is_known = s->t_channels >= t && s->t_channels <= t;
    if (!is_known) {
        from_scaled(s, y, s->watched_y);
    }
    dae_state state = *s->run->state;
    state.t = t;
    state.y = s->watched_y;
    const integrate_step step = {.t_from = s->t_watched,
                                 .t_to = t,
                                 .continues = s->continues,
                                 .state = &state,
                                 .watched = is_known ? s->channels : NULL,
                                 .with = s,
                                 .interpolate = interpolate};
    s->run->observer->watch(s->run->observer->self, &step);
    s->t_watched = t;
    s->continues = true;
}

/* Error weights as IDA would make them, in one loop instead of four. IDA asks for them before each step, when the one before is
 * complete and no event lies in it: the place to look at that. */
static int weights(N_Vector y, N_Vector weight, void *data)
{
    session *s = data;
    double t;
    if (IDAGetCurrentTime(s->ida, &t) == IDA_SUCCESS) {
        watch_to(s, t, y);
    }
    const double *values = N_VGetArrayPointer(y);
    double *to = N_VGetArrayPointer(weight);
    for (int i = 0; i < s->run->model->n; i++)
        to[i] = 1 / (relative_tolerance * fabs(values[i]) + s->run->options->tolerance);
    return 0;
}

#if SUNDIALS_VERSION_MAJOR < 7
/* The driver prints the one line about a failure. */
static void be_silent(int code, const char *module, const char *function, char *message, void *data)
{
    (void)code, (void)module, (void)function, (void)message, (void)data;
}
#endif

static void silence(session *s)
{
#if SUNDIALS_VERSION_MAJOR < 7
    IDASetErrHandlerFn(s->ida, be_silent, NULL);
#else
    SUNContext_ClearErrHandlers(s->context);
#endif
}

static void to_scaled(const session *s, const double *from, N_Vector to)
{
    double *values = N_VGetArrayPointer(to);
    for (int i = 0; i < s->run->model->n; i++) {
        values[i] = from[i] / s->run->model->scale[i];
    }
}

static bool allocate_arrays(session *s)
{
    const dae *m = s->run->model;
    s->row_units = calloc((size_t)m->n, sizeof(double));
    s->directions = calloc((size_t)m->n_roots + 1, sizeof(int));
    s->watched_y = calloc((size_t)m->n, sizeof(double));
    s->channels = calloc((size_t)m->n_watched + 1, sizeof(double));
    if (!s->row_units || !s->directions || !s->watched_y || !s->channels) {
        return false;
    }
    for (int i = 0; i < m->n; i++) {
        s->row_units[i] = 1 / m->row_scale[i];
    }
    return true;
}

static bool create_solver(session *s)
{
    const dae *m = s->run->model;
    if (SUNContext_Create(SUN_COMM_NULL, &s->context) != 0) {
        return false;
    }
    s->y = N_VNew_Serial(m->n, s->context);
    if (!s->y) {
        return false;
    }
    short_vectors_use(s->y);
    s->yp = N_VClone(s->y);
    s->id = N_VClone(s->y);
    s->between = N_VClone(s->y);
    s->matrix = SUNDenseMatrix(m->n, m->n, s->context);
    s->ida = IDACreate(s->context);
    if (!s->yp || !s->id || !s->between || !s->matrix || !s->ida) {
        return false;
    }
    s->solver = SUNLinSol_Dense(s->y, s->matrix, s->context);
    if (!s->solver) {
        return false;
    }
    short_vectors_solve(s->solver);
    return true;
}

static bool set_up(session *s)
{
    const dae *m = s->run->model;
    double *id = N_VGetArrayPointer(s->id);
    for (int i = 0; i < m->n; i++) {
        id[i] = m->differential[i];
    }
    to_scaled(s, s->run->state->y, s->y);
    to_scaled(s, s->run->state->yp, s->yp);
    silence(s);
    bool good = IDAInit(s->ida, residual, s->run->state->t, s->y, s->yp) == IDA_SUCCESS;
    good = good && IDAWFtolerances(s->ida, weights) == IDA_SUCCESS;
    good = good && IDASetUserData(s->ida, s) == IDA_SUCCESS && IDASetId(s->ida, s->id) == IDA_SUCCESS;
    good = good && IDASetLinearSolver(s->ida, s->solver, s->matrix) == IDA_SUCCESS;
    good = good && IDASetJacFn(s->ida, jacobian) == IDA_SUCCESS;
    good = good && IDASetDeltaCjLSetup(s->ida, matrix_staleness) == IDA_SUCCESS;
    good = good && IDASetMaxNumSteps(s->ida, steps_between_looks) == IDA_SUCCESS;
    good = good && IDASetMaxStep(s->ida, s->run->options->max_step) == IDA_SUCCESS;
    good = good && IDASetInitStep(s->ida, first_step) == IDA_SUCCESS;
    if (good && m->n_roots > 0) {
        m->root_directions(m->self, s->run->state->integers, s->directions);
        good = IDARootInit(s->ida, m->n_roots, roots) == IDA_SUCCESS &&
               IDASetRootDirection(s->ida, s->directions) == IDA_SUCCESS &&
               IDASetNoInactiveRootWarn(s->ida) == IDA_SUCCESS;
    }
    return good;
}

static void close_session(session *s)
{
    IDAFree(&s->ida);
    SUNLinSolFree(s->solver);
    SUNMatDestroy(s->matrix);
    N_VDestroy(s->y);
    N_VDestroy(s->yp);
    N_VDestroy(s->id);
    N_VDestroy(s->between);
    SUNContext_Free(&s->context);
    free(s->row_units);
    free(s->directions);
    free(s->watched_y);
    free(s->channels);
}

static void count(session *s)
{
    integrate_counts now = {0};
    IDAGetNumSteps(s->ida, &now.steps);
    IDAGetNumResEvals(s->ida, &now.residuals);
    IDAGetNumJacEvals(s->ida, &now.jacobians);
    IDAGetNumLinSolvSetups(s->ida, &now.linear_setups);
    IDAGetNumNonlinSolvIters(s->ida, &now.newton_iterations);
    IDAGetNumErrTestFails(s->ida, &now.error_test_failures);
    IDAGetNumNonlinSolvConvFails(s->ida, &now.convergence_failures);
    IDAGetNumGEvals(s->ida, &now.roots_evaluated);
    integrate_counts *total = s->run->counts;
    const integrate_counts *before = &s->before;
    total->steps = before->steps + now.steps;
    total->residuals = before->residuals + now.residuals;
    total->jacobians = before->jacobians + now.jacobians;
    total->linear_setups = before->linear_setups + now.linear_setups;
    total->newton_iterations = before->newton_iterations + now.newton_iterations;
    total->error_test_failures = before->error_test_failures + now.error_test_failures;
    total->convergence_failures = before->convergence_failures + now.convergence_failures;
    total->roots_evaluated = before->roots_evaluated + now.roots_evaluated;
}

/* The model's own words if it refused states beyond the last accepted one, else the integrator's. */
static integrate_code explain(session *s, int flag)
{
    if (!(s->t_refused > s->run->state->t)) {
        char *name = IDAGetReturnFlagName(flag);
        (void)snprintf(s->run->reason, DAE_MESSAGE_LENGTH, "the integrator cannot go on (%s)",
                       name ? name : "unknown reason");
        free(name);
    }
    return INTEGRATE_FAILED;
}

/* From the present state, in units of the scales. */
static integrate_code start_anew(session *s, double step)
{
    count(s);
    s->before = *s->run->counts;
    s->t_watched = s->run->state->t;
    s->t_channels = NAN; /* they belong to the motion before */
    s->continues = false;
    if (IDAReInit(s->ida, s->run->state->t, s->y, s->yp) != IDA_SUCCESS ||
        IDASetInitStep(s->ida, step) != IDA_SUCCESS) {
        (void)snprintf(s->run->reason, DAE_MESSAGE_LENGTH, "the integrator could not be started anew");
        return INTEGRATE_FAILED;
    }
    return INTEGRATE_DONE;
}

/* An event in the last step was missed: start anew where it began, with a step that is a part of it. */
static integrate_code take_back(session *s)
{
    double t = 0, step = 0;
    bool good = IDAGetCurrentTime(s->ida, &t) == IDA_SUCCESS && IDAGetLastStep(s->ida, &step) == IDA_SUCCESS;
    t -= step;
    good = good && IDAGetDky(s->ida, t, 0, s->y) == IDA_SUCCESS && IDAGetDky(s->ida, t, 1, s->yp) == IDA_SUCCESS;
    if (!good) {
        return INTEGRATE_FAILED; /* the reason is that of the missed event */
    }
    s->run->state->t = t;
    from_scaled(s, s->y, s->run->state->y);
    from_scaled(s, s->yp, s->run->state->yp);
    return start_anew(s, step / 4);
}

/* Hand over the present state if it lies on the grid; the end itself is handed over at the end. *missed: it was not, since an event
 * in the last step had been missed; the integration goes on from the beginning of that step. */
static integrate_code give_output(session *s, bool *missed)
{
    const double t_out = integration_output_time(s->run);
    *missed = false;
    if (integration_is_later(t_out, s->run->state->t) || t_out >= s->run->options->t_end) {
        return INTEGRATE_DONE;
    }
    const integrate_code code = integration_give_output(s->run, s->run->state, missed);
    if (*missed) {
        const integrate_code taken = take_back(s);
        return code == INTEGRATE_DONE ? taken : code;
    }
    s->run->next_output++;
    return code;
}

/* Apply what happened at the present state and start anew from there. */
static integrate_code handle_event(session *s, bool time_event)
{
    const dae *m = s->run->model;
    const integrate_code code = integration_apply_event(s->run, time_event);
    if (code != INTEGRATE_DONE) {
        return code;
    }
    to_scaled(s, s->run->state->y, s->y);
    to_scaled(s, s->run->state->yp, s->yp);
    m->root_directions(m->self, s->run->state->integers, s->directions);
    if (m->n_roots > 0 && IDASetRootDirection(s->ida, s->directions) != IDA_SUCCESS) {
        return explain(s, IDA_ILL_INPUT);
    }
    return start_anew(s, restart_step);
}

/* On to the next grid point, event or end, whichever comes first; IDA steps freely and interpolates. */
static integrate_code advance(session *s)
{
    const dae *m = s->run->model;
    const double t_event = m->next_time_event(m->self, s->run->state);
    const double t_stop = fmin(s->run->options->t_end, t_event);
    int flag = IDA_TSTOP_RETURN;
    if (!integration_is_later(t_stop, s->run->state->t)) {
        s->run->state->t = t_stop;
    } else {
        flag = IDASetStopTime(s->ida, t_stop);
        if (flag == IDA_SUCCESS) {
            flag = IDASetMinStep(s->ida, integration_smallest_step(fmax(s->run->state->t, first_step)));
        }
        if (flag == IDA_SUCCESS) {
            flag = IDASolve(s->ida, integration_output_time(s->run), &s->run->state->t, s->y, s->yp, IDA_NORMAL);
        }
        from_scaled(s, s->y, s->run->state->y);
        from_scaled(s, s->yp, s->run->state->yp);
        if (flag < 0 && flag != IDA_TOO_MUCH_WORK) {
            return explain(s, flag);
        }
        bool missed;
        const integrate_code code = give_output(s, &missed);
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
    watch_to(s, s->run->state->t, s->y);
    memset(s->run->fired, 0, (size_t)m->n_roots * sizeof(int));
    if (root && IDAGetRootInfo(s->ida, s->run->fired) != IDA_SUCCESS) {
        return explain(s, IDA_RTFUNC_FAIL);
    }
    return handle_event(s, time_event);
}

static integrate_code step_to_the_end(session *s)
{
    s->t_refused = -INFINITY;
    s->t_watched = s->run->state->t;
    s->t_channels = NAN;
    bool missed;
    integrate_code code = integration_give_output(s->run, s->run->state, &missed);
    if (missed) {
        return INTEGRATE_FAILED;
    }
    do {
        while (code == INTEGRATE_DONE && s->run->state->t < s->run->options->t_end) {
            code = advance(s);
        }
        if (code == INTEGRATE_DONE) {
            code = integration_give_output(s->run, s->run->state, &missed);
        }
        if (missed) {
            const integrate_code taken = take_back(s);
            code = code == INTEGRATE_DONE ? taken : code;
        }
    } while (code == INTEGRATE_DONE && missed);
    if (code != INTEGRATE_FAILED) {
        watch_to(s, s->run->state->t, s->y);
        integration_watch_state(s->run);
    }
    return code;
}

integrate_code integrate_by_ida(integration *run)
{
    session s = {.run = run};
    integrate_code code = INTEGRATE_FAILED;
    if (!allocate_arrays(&s) || !create_solver(&s)) {
        (void)snprintf(run->reason, DAE_MESSAGE_LENGTH, "there is not enough memory for the integrator");
    } else if (!set_up(&s)) {
        (void)snprintf(run->reason, DAE_MESSAGE_LENGTH, "the integrator refused its options");
    } else {
        code = step_to_the_end(&s);
        count(&s);
    }
    close_session(&s);
    return code;
}

const char *integrate_version(void)
{
    return "SUNDIALS " SUNDIALS_VERSION;
}
