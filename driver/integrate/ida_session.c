/* Differences between SUNDIALS 6 and 7 are confined to this file. */
#include "integrate/ida_session.h"

#include "integrate/short_vectors.h"

#include <ida/ida.h>
#include <math.h>
#include <nvector/nvector_serial.h>
#include <stddef.h>
#include <sundials/sundials_config.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_dense.h>

#if SUNDIALS_VERSION_MAJOR < 7
#define SUN_COMM_NULL NULL
#endif

void ida_session_from_scaled(const ida_session *s, N_Vector from, double *to)
{
    const double *values = N_VGetArrayPointer(from);
    for (int i = 0; i < s->run->model->n; i++) {
        to[i] = values[i] * s->run->model->scale[i];
    }
}

void ida_session_to_scaled(const ida_session *s, const double *from, N_Vector to)
{
    double *values = N_VGetArrayPointer(to);
    for (int i = 0; i < s->run->model->n; i++) {
        values[i] = from[i] / s->run->model->scale[i];
    }
}

#if SUNDIALS_VERSION_MAJOR < 7
/* The driver prints the one line about a failure. */
static void be_silent(int code, const char *module, const char *function, char *message, void *data)
{
    (void)code, (void)module, (void)function, (void)message, (void)data;
}
#endif

static void silence(ida_session *s)
{
#if SUNDIALS_VERSION_MAJOR < 7
    IDASetErrHandlerFn(s->ida, be_silent, NULL);
#else
    SUNContext_ClearErrHandlers(s->context);
#endif
}

static void allocate_arrays(ida_session *s)
{
    const dae *m = s->run->model;
    s->row_units = arena_calloc(&s->arena, (size_t)m->n, sizeof(double));
    s->directions = arena_calloc(&s->arena, (size_t)m->n_roots, sizeof(int));
    s->monitored_y = arena_calloc(&s->arena, (size_t)m->n, sizeof(double));
    s->channels = arena_calloc(&s->arena, (size_t)m->n_monitored, sizeof(double));
    s->cached = arena_calloc(&s->arena, (size_t)m->n_cached, sizeof(double));
    s->nodes = arena_calloc(&s->arena, 1, sizeof *s->nodes);
    s->nodes->t[IDA_NODES - 1] = NAN;
    s->rounding = ida_rounding_create(&s->arena, m->n);
    for (int i = 0; i < m->n; i++) {
        s->row_units[i] = 1 / m->row_scale[i];
    }
}

static bool create_linear_solver(ida_session *s)
{
    const dae *m = s->run->model;
    s->sparse = ida_sparse_open(m, s->y, s->context, &s->matrix, &s->solver);
    if (s->sparse != NULL) {
        return true;
    }
    s->matrix = SUNDenseMatrix(m->n, m->n, s->context);
    s->solver = s->matrix ? SUNLinSol_Dense(s->y, s->matrix, s->context) : NULL;
    if (!s->solver) {
        return false;
    }
    short_vectors_solve(s->solver);
    return true;
}

static bool create_solver(ida_session *s)
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
    s->between = N_VClone(s->y);
    s->ida = IDACreate(s->context);
    return s->yp && s->between && s->ida && create_linear_solver(s);
}

bool ida_session_open(ida_session *s)
{
    allocate_arrays(s);
    const bool good = create_solver(s);
    if (good) {
        silence(s);
    }
    return good;
}

void ida_session_close(ida_session *s)
{
    IDAFree(&s->ida);
    SUNLinSolFree(s->solver);
    SUNMatDestroy(s->matrix);
    ida_sparse_close(&s->sparse);
    N_VDestroy(s->y);
    N_VDestroy(s->yp);
    N_VDestroy(s->between);
    SUNContext_Free(&s->context);
    arena_free(&s->arena);
}

void ida_session_count(ida_session *s)
{
    /* offset of each counter, and the function that returns its value since the last restart */
    static const struct {
        size_t offset;
        int (*get)(void *ida, long *count);
    } counters[] = {{offsetof(integrate_counts, steps), IDAGetNumSteps},
                    {offsetof(integrate_counts, residuals), IDAGetNumResEvals},
                    {offsetof(integrate_counts, jacobians), IDAGetNumJacEvals},
                    {offsetof(integrate_counts, linear_setups), IDAGetNumLinSolvSetups},
                    {offsetof(integrate_counts, newton_iterations), IDAGetNumNonlinSolvIters},
                    {offsetof(integrate_counts, error_test_failures), IDAGetNumErrTestFails},
                    {offsetof(integrate_counts, convergence_failures), IDAGetNumNonlinSolvConvFails},
                    {offsetof(integrate_counts, roots_evaluated), IDAGetNumGEvals}};
    for (size_t i = 0; i < sizeof counters / sizeof *counters; i++) {
        long now = 0;
        (void)counters[i].get(s->ida, &now);
        *(long *)((char *)s->run->counts + counters[i].offset) =
            *(const long *)((const char *)&s->before + counters[i].offset) + now;
    }
}
