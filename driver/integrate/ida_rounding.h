/** Lower limit of IDA's tolerance due to rounding. The rounding error of F(t, y, y') is about eps |M| |y|, with its
 *  Jacobian M = dF/dy + cj dF/dy'; that of a correction is |M^-1| times that. This exceeds the rounding of y if
 *  positions of the order of a metre determine distances of a nanometre. All quantities are in IDA's units. Private to
 *  integrate/. */
#pragma once

#include "base/memory.h"
#include "integrate/ida_sparse.h"

#include <stdbool.h>
#include <sundials/sundials_linearsolver.h>
#include <sundials/sundials_matrix.h>
#include <sundials/sundials_nvector.h>

typedef struct {
    int n;
    int jacobians;     /**< number of Jacobians until the next estimate */
    bool is_due;       /**< the Jacobian is being factored */
    double *of_rows;   /**< [n] rounding error of F */
    double *of_states; /**< [n] rounding error of a correction; 0: unknown */
} ida_rounding;

ida_rounding ida_rounding_create(memory_arena *arena, int n);
/** Reset after a change of the discrete state. */
void ida_rounding_forget(ida_rounding *rounding);
/** Process a new Jacobian before its factorisation. sparse: NULL if it is dense */
void ida_rounding_note(ida_rounding *rounding, const ida_sparse *sparse, SUNMatrix jacobian, const double *y);
/** Update the estimate, if due, after the factorisation. a, b: two work vectors */
void ida_rounding_update(ida_rounding *rounding, SUNLinearSolver solver, SUNMatrix factors, N_Vector a, N_Vector b);
