/* After set-up the integrator allocates nothing: calls of the allocator are counted while it runs. */
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

enum { N_COUNTS = 10, EVENTS = 8, GROWTH_CUTS = 9 };

/* The test library's interface, see radau_capi.f90. */
void *rt_new_chain(int masses, double stiffness, double hardening, double damping, bool with_roots,
                   double kick_interval, double tolerance);
void rt_delete(void *handle);
void rt_counts(void *handle, int numbers[N_COUNTS]);
int rt_integrate_chain(void *handle, double *t, double *y, double t_end, double interval, int n_rows, double *rows);

enum { MASSES = 6, N = 2 * MASSES, ROWS = 101 };

/* glibc's own names of the allocator that is replaced here for the whole program */
void *__libc_malloc(size_t size);
void *__libc_calloc(size_t count, size_t size);
void *__libc_realloc(void *old, size_t size);

static long calls;

void *malloc(size_t size)
{
    calls++;
    return __libc_malloc(size);
}

void *calloc(size_t count, size_t size)
{
    calls++;
    return __libc_calloc(count, size);
}

void *realloc(void *old, size_t size)
{
    calls++;
    return __libc_realloc(old, size);
}

static double rows[ROWS * N];

static long calls_of_a_run(bool with_roots, double damping, double speed, int counts[N_COUNTS])
{
    void *solver = rt_new_chain(MASSES, 1e4, 5, damping, with_roots, 0.3, 1e-8);
    double t = 0, y[N] = {0.03 * speed, 0, 0, 0, 0, 0, speed};
    const long before = calls;
    assert_int_equal(rt_integrate_chain(solver, &t, y, 1, 0.01, ROWS, rows), 0);
    const long during = calls - before;
    rt_counts(solver, counts);
    rt_delete(solver);
    return during;
}

static void test_an_integration_allocates_nothing(void **state)
{
    (void)state;
    int counts[N_COUNTS];
    assert_int_equal(calls_of_a_run(false, 0.5, 10, counts), 0);
    assert_true(counts[0] > 50); /* steps: it did run */
}

static void test_events_allocate_nothing(void **state)
{
    (void)state;
    int counts[N_COUNTS];
    assert_int_equal(calls_of_a_run(true, 0.5, 10, counts), 0);
    assert_true(counts[EVENTS] > 50);
}

static void test_growth_allocates_nothing(void **state)
{
    (void)state;
    int counts[N_COUNTS];
    assert_int_equal(calls_of_a_run(false, -0.5, 1e-12, counts), 0);
    assert_true(counts[GROWTH_CUTS] > 0);
}

static void test_the_count_sees_the_set_up(void **state)
{
    (void)state;
    const long before = calls;
    rt_delete(rt_new_chain(MASSES, 1, 0, 0, true, 0, 1e-8));
    assert_true(calls - before > 20);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_the_count_sees_the_set_up),
        cmocka_unit_test(test_an_integration_allocates_nothing),
        cmocka_unit_test(test_events_allocate_nothing),
        cmocka_unit_test(test_growth_allocates_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
