/** Sparse matrices for IDA, with SUNDIALS' solver KLU if the build includes it. Private to integrate/. */
#pragma once

#include "integrate/dae.h"

#include <stdbool.h>
#include <sundials/sundials_linearsolver.h>
#include <sundials/sundials_matrix.h>
#include <sundials/sundials_nvector.h>

typedef struct ida_sparse ida_sparse;

/** Its part of integrate_version. */
#ifdef EVOLVENT_KLU
#define IDA_SPARSE_VERSION "with KLU"
#else
#define IDA_SPARSE_VERSION "without KLU"
#endif

/** Create a sparse matrix and its solver, if the build includes KLU and it is faster for the model. @return NULL if
 *  not, or if there is not enough memory: then use a dense matrix */
ida_sparse *ida_sparse_open(const dae *model, N_Vector like, SUNContext context, SUNMatrix *matrix,
                            SUNLinearSolver *solver);
void ida_sparse_close(ida_sparse **sparse);

/** The Jacobian in units of rows and states: row_units are those of its rows. @return a dae_code */
int ida_sparse_jacobian(const ida_sparse *sparse, const dae_state *state, double cj, const double *row_units,
                        SUNMatrix matrix, char message[DAE_MESSAGE_LENGTH]);

/** Add |matrix| |y| to sums: [n]. */
void ida_sparse_add_sizes(const ida_sparse *sparse, SUNMatrix matrix, const double *y, double *sums);
