/* Operations on short vectors against those of SUNDIALS itself: the same bits, whichever factors and places. */
#include "integrate/short_vectors.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>
#include <sundials/sundials_config.h>
#include <sunmatrix/sunmatrix_dense.h>

#include <cmocka.h>

#if SUNDIALS_VERSION_MAJOR < 7
#define SUN_COMM_NULL NULL
#endif

enum { MOST_ROWS = 23, N_VECTORS = 6 };

/* Twice the same vectors, once with the operations of SUNDIALS, once with ours. */
typedef struct {
    SUNContext context;
    int n;
    N_Vector plain[N_VECTORS], fast[N_VECTORS];
} twins;

static double next_number(void) /* of many sizes and both signs; the same in every run */
{
    static uint32_t seed = 12345;
    seed = seed * 1664525u + 1013904223u;
    return ldexp((double)(seed >> 8) / (1 << 23) - 1, (int)(seed % 40) - 20);
}

static void fill(twins *t)
{
    for (int k = 0; k < N_VECTORS; k++)
        for (int i = 0; i < t->n; i++)
            NV_Ith_S(t->plain[k], i) = NV_Ith_S(t->fast[k], i) = next_number();
}

static void create(twins *t, int n)
{
    assert_int_equal(SUNContext_Create(SUN_COMM_NULL, &t->context), 0);
    t->n = n;
    t->plain[0] = N_VNew_Serial(n, t->context);
    t->fast[0] = N_VNew_Serial(n, t->context);
    short_vectors_use(t->fast[0]);
    for (int k = 1; k < N_VECTORS; k++) {
        t->plain[k] = N_VClone(t->plain[0]);
        t->fast[k] = N_VClone(t->fast[0]);
    }
    assert_true(t->fast[1]->ops->nvlinearsum != t->plain[1]->ops->nvlinearsum);
    fill(t);
}

static void destroy(twins *t)
{
    for (int k = 0; k < N_VECTORS; k++) {
        N_VDestroy(t->plain[k]);
        N_VDestroy(t->fast[k]);
    }
    SUNContext_Free(&t->context);
}

static void assert_same(const twins *t)
{
    for (int k = 0; k < N_VECTORS; k++)
        assert_memory_equal(NV_DATA_S(t->plain[k]), NV_DATA_S(t->fast[k]), (size_t)t->n * sizeof(double));
}

static const double factors[] = {1.0, -1.0, 0.3, -0.3, 7.1, 0.0};
enum { N_FACTORS = sizeof factors / sizeof *factors };

static void linear_sums_have_the_bits_of_sundials(void **state)
{
    (void)state;
    static const int indices[][3] = {{0, 1, 2}, {0, 1, 0}, {0, 1, 1}, {2, 2, 2}};
    for (int n = 1; n <= MOST_ROWS; n++) {
        twins t;
        create(&t, n);
        for (int i = 0; i < N_FACTORS * N_FACTORS * 4; i++) {
            const double a = factors[i % N_FACTORS], b = factors[i / N_FACTORS % N_FACTORS];
            const int *at = indices[i / (N_FACTORS * N_FACTORS)];
            fill(&t);
            N_VLinearSum(a, t.plain[at[0]], b, t.plain[at[1]], t.plain[at[2]]);
            N_VLinearSum(a, t.fast[at[0]], b, t.fast[at[1]], t.fast[at[2]]);
            assert_same(&t);
            fill(&t);
            assert_int_equal(N_VLinearSumVectorArray(3, a, t.plain, b, t.plain + 3, t.plain), 0);
            assert_int_equal(N_VLinearSumVectorArray(3, a, t.fast, b, t.fast + 3, t.fast), 0);
            assert_same(&t);
        }
        destroy(&t);
    }
}

static void linear_combinations_have_the_bits_of_sundials(void **state)
{
    (void)state;
    for (int n = 1; n <= MOST_ROWS; n++) {
        twins t;
        create(&t, n);
        for (int n_vectors = 1; n_vectors < N_VECTORS; n_vectors++) {
            for (int i = 0; i < N_FACTORS; i++) {
                double c[N_VECTORS];
                for (int k = 0; k < N_VECTORS; k++)
                    c[k] = k == 0 ? factors[i] : next_number();
                for (int to = 0; to < N_VECTORS; to += N_VECTORS - 1) { /* in place, and elsewhere */
                    fill(&t);
                    assert_int_equal(N_VLinearCombination(n_vectors, c, t.plain, t.plain[to]), 0);
                    assert_int_equal(N_VLinearCombination(n_vectors, c, t.fast, t.fast[to]), 0);
                    assert_same(&t);
                }
            }
        }
        destroy(&t);
    }
}

static void scaling_and_constants_have_the_bits_of_sundials(void **state)
{
    (void)state;
    for (int n = 1; n <= MOST_ROWS; n++) {
        twins t;
        create(&t, n);
        for (int i = 0; i < N_FACTORS; i++) {
            for (int to = 0; to < 2; to++) {
                fill(&t);
                N_VScale(factors[i], t.plain[0], t.plain[to]);
                N_VScale(factors[i], t.fast[0], t.fast[to]);
                N_VConst(factors[i], t.plain[5]);
                N_VConst(factors[i], t.fast[5]);
                assert_same(&t);
            }
            double c[] = {factors[i], 2.5, -1.0};
            assert_int_equal(N_VScaleVectorArray(3, c, t.plain, t.plain + 3), 0);
            assert_int_equal(N_VScaleVectorArray(3, c, t.fast, t.fast + 3), 0);
            assert_same(&t);
        }
        destroy(&t);
    }
}

static void norms_have_the_bits_of_sundials(void **state)
{
    (void)state;
    for (int n = 1; n <= MOST_ROWS; n++) {
        twins t;
        create(&t, n);
        const double plain = N_VWrmsNorm(t.plain[0], t.plain[1]), fast = N_VWrmsNorm(t.fast[0], t.fast[1]);
        assert_memory_equal(&plain, &fast, sizeof plain);
        destroy(&t);
    }
}

static void solutions_have_the_bits_of_sundials(void **state)
{
    (void)state;
    for (int n = 1; n <= MOST_ROWS; n++) {
        twins t;
        create(&t, n);
        SUNMatrix matrix = SUNDenseMatrix(n, n, t.context);
        for (int i = 0; i < n * n; i++)
            SUNDenseMatrix_Data(matrix)[i] = next_number();
        SUNLinearSolver solver = SUNLinSol_Dense(t.plain[0], matrix, t.context);
        assert_int_equal(SUNLinSolInitialize(solver), 0);
        assert_int_equal(SUNLinSolSetup(solver, matrix), 0);
        assert_int_equal(SUNLinSolSolve(solver, matrix, t.plain[0], t.plain[1], 0), 0);
        short_vectors_solve(solver);
        assert_true(solver->ops->solve != SUNLinSolSolve_Dense);
        assert_int_equal(SUNLinSolSolve(solver, matrix, t.fast[0], t.fast[1], 0), 0);
        assert_same(&t);
        /* in place, as IDA does it */
        assert_int_equal(SUNLinSolSolve_Dense(solver, matrix, t.plain[2], t.plain[2], 0), 0);
        assert_int_equal(SUNLinSolSolve(solver, matrix, t.fast[2], t.fast[2], 0), 0);
        assert_same(&t);
        SUNLinSolFree(solver);
        SUNMatDestroy(matrix);
        destroy(&t);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(linear_sums_have_the_bits_of_sundials),
        cmocka_unit_test(linear_combinations_have_the_bits_of_sundials),
        cmocka_unit_test(scaling_and_constants_have_the_bits_of_sundials),
        cmocka_unit_test(norms_have_the_bits_of_sundials),
        cmocka_unit_test(solutions_have_the_bits_of_sundials),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
