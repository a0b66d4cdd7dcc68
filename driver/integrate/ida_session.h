/** What an integration with IDA has beside an integration. IDA gets states in units of their scales, so that one absolute tolerance
 *  holds for all of them. Private to integrate/. */
#pragma once

#include "base/memory.h"
#include "integrate/ida_rounding.h"
#include "integrate/ida_sparse.h"
#include "integrate/integration.h"

#include <sundials/sundials_linearsolver.h>
#include <sundials/sundials_matrix.h>
#include <sundials/sundials_nvector.h>

/** Enough for the polynomials of IDA, of degree 5. */
enum { IDA_NODES = 6 };

/** The last step at some times in it, from which single states follow. */
typedef struct {
    double t[IDA_NODES]; /**< the last one is the end; NAN: nothing is known */
    double *y;           /**< [n * IDA_NODES] of each state the times side by side; NULL: not asked for yet */
    double *one;         /**< [n] */
} ida_nodes;

typedef struct {
    memory_pool pool;        /**< of the arrays */
    integration *run;        /**< the states in it are in physical units */
    integrate_counts before; /**< until the last restart: IDAReInit starts its counters anew */
    double *row_units;       /**< 1/row_scale */
    int *directions;
    SUNContext context;
    void *ida;
    N_Vector y, yp;
    N_Vector between;   /**< state inside a step, for who watches */
    double *watched_y;  /**< [n] */
    double t_watched;   /**< up to which the observer has seen the motion */
    double *channels;   /**< [n_watched] watched channels where the roots were asked last */
    double t_channels;  /**< when that was */
    double *kept;       /**< [n_kept] */
    bool continues;     /**< nothing happened there */
    ida_nodes *nodes;   /**< in the last step that was asked for */
    ida_sparse *sparse; /**< NULL: the matrix is full */
    SUNMatrix matrix;
    SUNLinearSolver solver;
    ida_rounding rounding;
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
/** The same of some states: of long trains, where it is asked for at many times. */
bool ida_interpolate_some(void *with, double t, int n, const int *states, double *y);
/** Let the observer look at the motion from where it has seen it to t, in the last step. */
void ida_watch_to(ida_session *s, double t, N_Vector y);
