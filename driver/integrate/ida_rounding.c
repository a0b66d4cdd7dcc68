#include "integrate/ida_rounding.h"

#include <float.h>
#include <math.h>
#include <string.h>
#include <sunmatrix/sunmatrix_dense.h>

/* An estimate takes n solutions: it is made for one of this number of Jacobians, or of n. If rounding dominates,
 * Jacobians are frequent. */
enum { LEAST_JACOBIANS = 16 };

static int jacobians_of(int n)
{
    return n > LEAST_JACOBIANS ? n : LEAST_JACOBIANS;
}

ida_rounding ida_rounding_create(memory_arena *arena, int n)
{
    return (ida_rounding){.n = n,
                          .jacobians = jacobians_of(n),
                          .of_rows = arena_calloc(arena, (size_t)n, sizeof(double)),
                          .of_states = arena_calloc(arena, (size_t)n, sizeof(double))};
}

void ida_rounding_forget(ida_rounding *rounding)
{
    rounding->jacobians = jacobians_of(rounding->n);
    rounding->is_due = false;
    memset(rounding->of_states, 0, (size_t)rounding->n * sizeof(double));
}

void ida_rounding_note(ida_rounding *rounding, const ida_sparse *sparse, SUNMatrix jacobian, const double *y)
{
    const int n = rounding->n;
    rounding->is_due = --rounding->jacobians <= 0;
    if (!rounding->is_due) {
        return;
    }
    memset(rounding->of_rows, 0, (size_t)n * sizeof(double));
    if (sparse != NULL) {
        ida_sparse_add_sizes(sparse, jacobian, y, rounding->of_rows);
    } else {
        const double *entries = SUNDenseMatrix_Data(jacobian);
        for (int j = 0; j < n; j++)
            for (int i = 0; i < n; i++)
                rounding->of_rows[i] += fabs(entries[j * n + i] * y[j]);
    }
    for (int i = 0; i < n; i++)
        rounding->of_rows[i] *= DBL_EPSILON;
}

void ida_rounding_update(ida_rounding *rounding, SUNLinearSolver solver, SUNMatrix factors, N_Vector a, N_Vector b)
{
    if (!rounding->is_due) {
        return;
    }
    const size_t n = (size_t)rounding->n;
    double *one = N_VGetArrayPointer(a);
    const double *solution = N_VGetArrayPointer(b);
    ida_rounding_forget(rounding);
    for (size_t j = 0; j < n; j++) {
        memset(one, 0, n * sizeof(double));
        one[j] = rounding->of_rows[j];
        if (SUNLinSolSolve(solver, factors, b, a, 0) != 0) {
            ida_rounding_forget(rounding);
            return;
        }
        for (size_t i = 0; i < n; i++)
            rounding->of_states[i] += fabs(solution[i]);
    }
}
