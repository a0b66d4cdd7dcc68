/** What rounding makes of IDA's corrections: no tolerance can ask for less. F(t, y, y') is rounded by about eps |M| |y|, M being its
 *  Jacobian dF/dy + cj dF/dy', and a correction by |M^-1| times that: more than the rounding of y where places a metre apart hold a
 *  nanometre. All is in the units that IDA is given. Private to integrate/. */
#pragma once

#include "base/memory.h"
#include "integrate/ida_sparse.h"

#include <stdbool.h>
#include <sundials/sundials_linearsolver.h>
#include <sundials/sundials_matrix.h>
#include <sundials/sundials_nvector.h>

typedef struct {
    int n;
    int jacobians;     /**< until one is looked at, since the last answer or event */
    bool is_due;       /**< the Jacobian is being factored */
    double *of_rows;   /**< [n] rounding of F */
    double *of_states; /**< [n] rounding of a correction; 0: nothing is known */
} ida_rounding;

ida_rounding ida_rounding_create(memory_pool *pool, int n);
/** Another discrete state holds. */
void ida_rounding_forget(ida_rounding *rounding);
/** There is a new Jacobian, not factored yet. sparse: NULL if it is full */
void ida_rounding_note(ida_rounding *rounding, const ida_sparse *sparse, SUNMatrix jacobian, const double *y);
/** Look at it, if that is due, now that it is factored. a, b: two vectors to work with */
void ida_rounding_update(ida_rounding *rounding, SUNLinearSolver solver, SUNMatrix factors, N_Vector a, N_Vector b);
