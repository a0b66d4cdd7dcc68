/** What an integration with IDA has beside an integration. IDA gets states in units of their scales, so that one absolute tolerance
 *  holds for all of them. Private to integrate/. */
#pragma once

#include "base/memory.h"
#include "integrate/integration.h"

#include <sundials/sundials_linearsolver.h>
#include <sundials/sundials_matrix.h>
#include <sundials/sundials_nvector.h>

typedef struct {
    memory_pool pool;        /**< of the arrays */
    integration *run;        /**< the states in it are in physical units */
    integrate_counts before; /**< until the last restart: IDAReInit starts its counters anew */
    double *row_units;       /**< 1/row_scale */
    int *directions;
    SUNContext context;
    void *ida;
    N_Vector y, yp;
    N_Vector between;  /**< state inside a step, for who watches */
    double *watched_y; /**< [n] */
    double t_watched;  /**< up to which the observer has seen the motion */
    double *channels;  /**< [n_watched] watched channels where the roots were asked last */
    double t_channels; /**< when that was */
    double *kept;      /**< [n_kept] */
    bool continues;    /**< nothing happened there */
    SUNMatrix matrix;
    SUNLinearSolver solver;
    double t_refused; /**< latest time at which the model had no answer */
} ida_session;

/** Everything that takes memory. @return whether there was enough; ida_session_close is due in any case */
bool ida_session_open(ida_session *s);
void ida_session_close(ida_session *s);

void ida_session_from_scaled(const ida_session *s, N_Vector from, double *to);
void ida_session_to_scaled(const ida_session *s, const double *from, N_Vector to);

/** Bring the run's counts up to date. */
void ida_session_count(ida_session *s);

/* What IDA asks of an integration, as functions of the kinds that it wants; `data` is the session. */
int ida_residual(sunrealtype t, N_Vector y, N_Vector yp, N_Vector r, void *data);
int ida_jacobian(sunrealtype t, sunrealtype cj, N_Vector y, N_Vector yp, N_Vector r, SUNMatrix matrix, void *data,
                 N_Vector a, N_Vector b, N_Vector c);
int ida_roots(sunrealtype t, N_Vector y, N_Vector yp, sunrealtype *values, void *data);
int ida_weights(N_Vector y, N_Vector weight, void *data);

/** y at t in the last step; a function of the kind that integrate_step has, `with` being the session. */
bool ida_interpolate(const void *with, double t, double *y);
/** Let the observer look at the motion from where it has seen it to t, in the last step. */
void ida_watch_to(ida_session *s, double t, N_Vector y);
