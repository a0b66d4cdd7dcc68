#include "integrate/ida_session.h"

#include <float.h>
#include <ida/ida.h>
#include <math.h>
#include <sunmatrix/sunmatrix_dense.h>

/* Only for quantities without bound, such as the gap of flanks that never meet again, and for the rounding of F: the
 * tolerance is not smaller than these permit. */
enum { ROUNDINGS = 16 };
static const double relative_tolerance = ROUNDINGS * DBL_EPSILON;

/* The discrete state cannot change while IDA steps: trial states share that of the caller. */
static void take_trial(ida_session *s, double t, N_Vector y, N_Vector yp)
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

static void note_refusal(ida_session *s, int code)
{
    if (code != DAE_OK) {
        s->t_refused = s->run->trial.t;
    }
}

int ida_residual(sunrealtype t, N_Vector y, N_Vector yp, N_Vector r, void *data)
{
    ida_session *s = data;
    take_trial(s, t, y, yp);
    const dae_state state = integration_borrowed(s->run);
    double *rows = N_VGetArrayPointer(r);
    const int code = s->run->model->residual(s->run->model->self, &state, rows, s->run->reason);
    note_refusal(s, code);
    for (int i = 0; i < s->run->model->n; i++)
        rows[i] *= s->row_units[i];
    return code;
}

int ida_jacobian(sunrealtype t, sunrealtype cj, N_Vector y, N_Vector yp, N_Vector r, SUNMatrix matrix, void *data,
                 N_Vector a, N_Vector b, N_Vector c)
{
    (void)r, (void)a, (void)b, (void)c;
    ida_session *s = data;
    const int n = s->run->model->n;
    take_trial(s, t, y, yp);
    const dae_state state = integration_borrowed(s->run);
    if (s->sparse != NULL) {
        const int result = ida_sparse_jacobian(s->sparse, &state, cj, s->row_units, matrix, s->run->reason);
        note_refusal(s, result);
        ida_rounding_note(&s->rounding, s->sparse, matrix, N_VGetArrayPointer(y));
        return result;
    }
    double *entries = SUNDenseMatrix_Data(matrix);
    const int code = s->run->model->jacobian(s->run->model->self, &state, cj, entries, s->run->reason);
    note_refusal(s, code);
    for (int j = 0; j < n; j++)
        for (int i = 0; i < n; i++)
            entries[j * n + i] *= s->row_units[i] * s->run->model->scale[j];
    ida_rounding_note(&s->rounding, NULL, matrix, N_VGetArrayPointer(y));
    return code;
}

int ida_roots(sunrealtype t, N_Vector y, N_Vector yp, sunrealtype *values, void *data)
{
    ida_session *s = data;
    take_trial(s, t, y, yp);
    const dae_state state = integration_borrowed(s->run);
    const dae *m = s->run->model;
    const bool is_monitored = s->run->observer->monitor != NULL;
    const int code = is_monitored ? m->roots_and_monitored(m->self, &state, s->run->observer->highest, s->cached,
                                                           values, s->channels, s->run->reason)
                                  : m->roots(m->self, &state, values, s->run->reason);
    s->t_channels = is_monitored && code == DAE_OK ? t : NAN;
    note_refusal(s, code);
    return code;
}

bool ida_interpolate(const void *with, double t, double *y)
{
    const ida_session *s = with;
    if (IDAGetDky(s->ida, t, 0, s->between) != IDA_SUCCESS) {
        return false;
    }
    ida_session_from_scaled(s, s->between, y);
    return true;
}

/* Evaluate the state at equidistant nodes over the last step. */
static bool find_nodes(ida_session *s, double from, double to)
{
    ida_nodes *nodes = s->nodes;
    const size_t n = (size_t)s->run->model->n;
    if (nodes->y == NULL) {
        nodes->y = arena_calloc(&s->arena, n * IDA_NODES, sizeof(double));
        nodes->one = arena_calloc(&s->arena, n, sizeof(double));
    }
    for (int k = 0; k < IDA_NODES; k++) {
        nodes->t[k] = k == IDA_NODES - 1 ? to : from + (to - from) * k / (IDA_NODES - 1);
        if (!ida_interpolate(s, nodes->t[k], nodes->one)) {
            nodes->t[IDA_NODES - 1] = NAN;
            return false;
        }
        for (size_t i = 0; i < n; i++)
            nodes->y[i * IDA_NODES + (size_t)k] = nodes->one[i];
    }
    return true;
}

bool ida_interpolate_some(void *with, double t, int n, const int *states, double *y)
{
    ida_session *s = with;
    const ida_nodes *nodes = s->nodes;
    double to = 0, step = 0, weights[IDA_NODES];
    (void)IDAGetCurrentTime(s->ida, &to);
    (void)IDAGetLastStep(s->ida, &step);
    const bool is_known = nodes->t[IDA_NODES - 1] >= to && nodes->t[IDA_NODES - 1] <= to;
    if (!is_known && !find_nodes(s, to - step, to)) {
        return false;
    }
    for (int k = 0; k < IDA_NODES; k++) {
        weights[k] = 1;
        for (int j = 0; j < IDA_NODES; j++)
            weights[k] *= j == k ? 1 : (t - nodes->t[j]) / (nodes->t[k] - nodes->t[j]);
    }
    for (int i = 0; i < n; i++) {
        const double *values = nodes->y + (size_t)states[i] * IDA_NODES;
        y[states[i]] = 0;
        for (int k = 0; k < IDA_NODES; k++)
            y[states[i]] += weights[k] * values[k];
    }
    return true;
}

void ida_monitor_to(ida_session *s, double t, N_Vector y)
{
    if (s->run->observer->monitor == NULL || !(t > s->t_monitored)) {
        return;
    }
    const bool is_known = s->t_channels >= t && s->t_channels <= t;
    if (!is_known) {
        ida_session_from_scaled(s, y, s->monitored_y);
    }
    dae_state state = *s->run->state;
    state.t = t;
    state.y = s->monitored_y;
    const integrate_step step = {.t_from = s->t_monitored,
                                 .t_to = t,
                                 .continues = s->continues,
                                 .state = &state,
                                 .monitored = is_known ? s->channels : NULL,
                                 .with = s,
                                 .interpolate = ida_interpolate,
                                 .interpolate_some = ida_interpolate_some};
    s->run->observer->monitor(s->run->observer->self, &step);
    s->t_monitored = t;
    s->continues = true;
}

/* Error weights as IDA computes them, in one loop instead of four. IDA requests them before each step, when the
 * previous one is complete and has no event: here the observer processes it. */
int ida_weights(N_Vector y, N_Vector weight, void *data)
{
    ida_session *s = data;
    double t;
    if (IDAGetCurrentTime(s->ida, &t) == IDA_SUCCESS) {
        ida_monitor_to(s, t, y);
    }
    ida_rounding_update(&s->rounding, s->solver, s->matrix, s->between, weight);
    const double *values = N_VGetArrayPointer(y);
    const double *rounded = s->rounding.of_states;
    double *to = N_VGetArrayPointer(weight);
    for (int i = 0; i < s->run->model->n; i++) {
        const double asked = relative_tolerance * fabs(values[i]) + s->run->options->tolerance;
        to[i] = 1 / fmax(asked, ROUNDINGS * rounded[i]);
    }
    return 0;
}
