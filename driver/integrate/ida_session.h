/** Data of an integration with IDA in addition to `integration`. IDA's states are in units of their scales, so that one
 *  absolute tolerance applies to all of them. Private to integrate/. */
#pragma once

#include "base/memory.h"
#include "integrate/ida_rounding.h"
#include "integrate/ida_sparse.h"
#include "integrate/integration.h"

#include <sundials/sundials_linearsolver.h>
#include <sundials/sundials_matrix.h>
#include <sundials/sundials_nvector.h>

/** Sufficient for the polynomials of IDA, of degree 5. */
enum { IDA_NODES = 6 };

/** The last step at several times in it, for interpolation of single states. */
typedef struct {
    double t[IDA_NODES]; /**< the last one is the end; NAN: unknown */
    double *y;           /**< [n * IDA_NODES] for each state the values at the times; NULL: not requested yet */
    double *one;         /**< [n] */
} ida_nodes;

typedef struct {
    memory_arena arena;      /**< owns the arrays */
    integration *run;        /**< its states are in physical units */
    integrate_counts before; /**< until the last restart: IDAReInit resets its counters */
    double *row_units;       /**< 1/row_scale */
    int *directions;
    SUNContext context;
    void *ida;
    N_Vector y, yp;
    N_Vector between;    /**< state within a step, for observers */
    double *monitored_y; /**< [n] */
    double t_monitored;  /**< time up to which the observer has processed the motion */
    double *channels;    /**< [n_monitored] watched channels at the last evaluation of the root functions */
    double t_channels;   /**< time of that evaluation */
    double *cached;      /**< [n_cached] */
    bool continues;      /**< there was no event at t_monitored */
    ida_nodes *nodes;    /**< in the last step for which they were requested */
    ida_sparse *sparse;  /**< NULL: the matrix is dense */
    SUNMatrix matrix;
    SUNLinearSolver solver;
    ida_rounding rounding;
    double t_refused; /**< latest time at which the model refused a state */
} ida_session;

/** Allocate everything. @return whether there was enough memory; ida_session_close is required in any case */
bool ida_session_open(ida_session *s);
void ida_session_close(ida_session *s);

void ida_session_from_scaled(const ida_session *s, N_Vector from, double *to);
void ida_session_to_scaled(const ida_session *s, const double *from, N_Vector to);

/** Update the run's counters. */
void ida_session_count(ida_session *s);

/* Callbacks of IDA; `data` is the session. */
int ida_residual(sunrealtype t, N_Vector y, N_Vector yp, N_Vector r, void *data);
int ida_jacobian(sunrealtype t, sunrealtype cj, N_Vector y, N_Vector yp, N_Vector r, SUNMatrix matrix, void *data,
                 N_Vector a, N_Vector b, N_Vector c);
int ida_roots(sunrealtype t, N_Vector y, N_Vector yp, sunrealtype *values, void *data);
int ida_weights(N_Vector y, N_Vector weight, void *data);

/** y at t in the last step; has the type of integrate_step.interpolate, with the session as `with`. */
bool ida_interpolate(const void *with, double t, double *y);
/** Same for some states only: for long trains, with many evaluations. */
bool ida_interpolate_some(void *with, double t, int n, const int *states, double *y);
/** Let the observer process the motion from t_monitored to t, in the last step. */
void ida_monitor_to(ida_session *s, double t, N_Vector y);
