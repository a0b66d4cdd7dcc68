/* Means of the halves of a window, from blocks of periods in bounded memory. */
#include "simulate/metric_blocks.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

/* Periods of 2 s whose means are 3 and 5 by turns in channel 0, and their numbers from 0 in channel 1. */
static bool halves_of(int n_periods, block_halves halves[2])
{
    ARENA_SCOPE memory_arena arena = {NULL};
    metric_blocks blocks;
    metric_blocks_init(&blocks, 2, &arena);
    for (int i = 0; i < n_periods; i++) {
        metric_blocks_period(&blocks, 2);
        metric_blocks_add(&blocks, 0, 2 * (i % 2 == 0 ? 3 : 5));
        metric_blocks_add(&blocks, 1, 2 * i);
    }
    return metric_blocks_halves(&blocks, 0, &halves[0]) && metric_blocks_halves(&blocks, 1, &halves[1]);
}

static void test_less_than_four_periods_have_no_halves(void **state)
{
    (void)state;
    block_halves halves[2];
    for (int n = 1; n < 4; n++) {
        assert_false(halves_of(n, halves));
    }
    assert_true(halves_of(4, halves));
    assert_float_equal(halves[0].first, 4, 1e-15);
    assert_float_equal(halves[0].second, 4, 1e-15);
    assert_float_equal(halves[0].scatter, sqrt(2), 1e-15); /* four distances of 1, two degrees of freedom */
    assert_float_equal(halves[1].first, 0.5, 1e-15);
    assert_float_equal(halves[1].second, 2.5, 1e-15);
}

static void test_the_middle_of_an_odd_number_belongs_to_no_half(void **state)
{
    (void)state;
    block_halves halves[2];
    assert_true(halves_of(7, halves));
    assert_float_equal(halves[1].first, 1, 1e-15);
    assert_float_equal(halves[1].second, 5, 1e-15);
}

/* However many there are: of blocks that are not full, or in the middle, a sixteenth of all periods at most is left out. */
static void test_long_windows_have_the_same_halves(void **state)
{
    (void)state;
    for (int n = 4; n <= 3000; n++) {
        block_halves halves[2];
        assert_true(halves_of(n, halves));
        const double spread = halves[1].second - halves[1].first;
        assert_true(fabs(spread - 0.5 * n) <= n / 16.0 + 1);
        if (n > METRIC_BLOCKS) { /* each block has as many of both kinds */
            assert_float_equal(halves[0].first, 4, 1e-12);
            assert_float_equal(halves[0].scatter, 0, 1e-12);
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_less_than_four_periods_have_no_halves),
        cmocka_unit_test(test_the_middle_of_an_odd_number_belongs_to_no_half),
        cmocka_unit_test(test_long_windows_have_the_same_halves),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
