#include "integrate/short_vectors.h"

#include <math.h>
#include <stdbool.h>
#include <sunmatrix/sunmatrix_dense.h>

static sunindextype length(N_Vector x)
{
    return NV_LENGTH_S(x);
}

/* Equal factors multiply the sum once, as in SUNDIALS: same rounding, and with factors of one the same sign of zeros. */
static void linear_sum(sunrealtype a, N_Vector x, sunrealtype b, N_Vector y, N_Vector z)
{
    const sunindextype n = length(x);
    const sunrealtype *from_x = NV_DATA_S(x), *from_y = NV_DATA_S(y);
    sunrealtype *to = NV_DATA_S(z);
    const bool is_one = fabs(b) == 1;
    if (a == b && !is_one) {
        for (sunindextype i = 0; i < n; i++)
            to[i] = a * (from_x[i] + from_y[i]);
    } else if (a == -b && !is_one) {
        for (sunindextype i = 0; i < n; i++)
            to[i] = a * (from_x[i] - from_y[i]);
    } else {
        for (sunindextype i = 0; i < n; i++)
            to[i] = a * from_x[i] + b * from_y[i];
    }
}

static void scale(sunrealtype c, N_Vector x, N_Vector z)
{
    const sunindextype n = length(x);
    const sunrealtype *from = NV_DATA_S(x);
    sunrealtype *to = NV_DATA_S(z);
    for (sunindextype i = 0; i < n; i++)
        to[i] = c * from[i];
}

static void set_constant(sunrealtype c, N_Vector z)
{
    const sunindextype n = length(z);
    sunrealtype *to = NV_DATA_S(z);
    for (sunindextype i = 0; i < n; i++)
        to[i] = c;
}

static sunrealtype wrms_norm(N_Vector x, N_Vector weight)
{
    const sunindextype n = length(x);
    const sunrealtype *value = NV_DATA_S(x), *by = NV_DATA_S(weight);
    sunrealtype sum = 0;
    for (sunindextype i = 0; i < n; i++) {
        const sunrealtype product = value[i] * by[i];
        sum += product * product;
    }
    return sqrt(sum / (sunrealtype)n);
}

/* Combine several rows from row i on. Their number is known at compile time, so that the sums stay in registers. */
static inline void combine_rows(int n_rows, sunindextype i, int n_vectors, const sunrealtype *c, N_Vector *x,
                                N_Vector z)
{
    enum { MOST = 8 };
    sunrealtype sum[MOST];
    const sunrealtype *from = NV_DATA_S(x[0]) + i;
    for (int j = 0; j < n_rows; j++)
        sum[j] = c[0] * from[j];
    for (int k = 1; k < n_vectors; k++) {
        from = NV_DATA_S(x[k]) + i;
        for (int j = 0; j < n_rows; j++)
            sum[j] += c[k] * from[j];
    }
    sunrealtype *to = NV_DATA_S(z) + i;
    for (int j = 0; j < n_rows; j++)
        to[j] = sum[j];
}

static int linear_combination(int n_vectors, sunrealtype *c, N_Vector *x, N_Vector z)
{
    if (n_vectors == 2) {
        linear_sum(c[0], x[0], c[1], x[1], z);
        return 0;
    }
    const sunindextype n = length(z);
    sunindextype i = 0;
    for (; i + 8 <= n; i += 8)
        combine_rows(8, i, n_vectors, c, x, z);
    for (; i + 4 <= n; i += 4)
        combine_rows(4, i, n_vectors, c, x, z);
    for (; i + 2 <= n; i += 2)
        combine_rows(2, i, n_vectors, c, x, z);
    if (i < n)
        combine_rows(1, i, n_vectors, c, x, z);
    return 0;
}

static int linear_sums(int n_vectors, sunrealtype a, N_Vector *x, sunrealtype b, N_Vector *y, N_Vector *z)
{
    for (int k = 0; k < n_vectors; k++)
        linear_sum(a, x[k], b, y[k], z[k]);
    return 0;
}

static int scale_each(int n_vectors, sunrealtype *c, N_Vector *x, N_Vector *z)
{
    for (int k = 0; k < n_vectors; k++)
        scale(c[k], x[k], z[k]);
    return 0;
}

void short_vectors_use(N_Vector vector)
{
    vector->ops->nvlinearsum = linear_sum;
    vector->ops->nvscale = scale;
    vector->ops->nvconst = set_constant;
    vector->ops->nvwrmsnorm = wrms_norm;
    vector->ops->nvlinearcombination = linear_combination;
    vector->ops->nvlinearsumvectorarray = linear_sums;
    vector->ops->nvscalevectorarray = scale_each;
}

/* L is unit lower, U upper triangular; pivots[k] is the row that was exchanged with row k. */
static int solve(SUNLinearSolver solver, SUNMatrix matrix, N_Vector x, N_Vector b, sunrealtype tolerance)
{
    (void)tolerance;
    SUNLinearSolverContent_Dense content = solver->content;
    const sunindextype n = content->N;
    sunrealtype *const *columns = SM_COLS_D(matrix);
    sunrealtype *restrict row = NV_DATA_S(x);
    scale(1, b, x);
    for (sunindextype k = 0; k < n; k++) {
        const sunindextype other = content->pivots[k];
        const sunrealtype saved = row[k];
        row[k] = row[other];
        row[other] = saved;
    }
    /* Two columns at a time: a row is loaded and stored half as often, with the same order of operations. */
    sunindextype k = 0;
    for (; k + 1 < n; k += 2) {
        const sunrealtype *restrict first = columns[k], *restrict second = columns[k + 1];
        const sunrealtype by = row[k], next = row[k + 1] - first[k + 1] * by;
        row[k + 1] = next;
        for (sunindextype i = k + 2; i < n; i++)
            row[i] = row[i] - first[i] * by - second[i] * next;
    }
    for (k = n - 1; k > 0; k -= 2) {
        const sunrealtype *restrict first = columns[k], *restrict second = columns[k - 1];
        const sunrealtype by = row[k] / first[k], next = (row[k - 1] - first[k - 1] * by) / second[k - 1];
        row[k] = by;
        row[k - 1] = next;
        for (sunindextype i = 0; i < k - 1; i++)
            row[i] = row[i] - first[i] * by - second[i] * next;
    }
    if (k == 0)
        row[0] /= columns[0][0];
    content->last_flag = 0;
    return 0;
}

void short_vectors_solve(SUNLinearSolver solver)
{
    solver->ops->solve = solve;
}
