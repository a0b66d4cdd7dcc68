/* Whether a run gets on. */
#include "integrate/progress_rate.h"

#include <float.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

static const dae_event impact = {.kind = 3, .subject = 0, .side = 0, .count = 0};

/* A ball that bounces with this restitution, from t = 1: how often until its bounces count as stuck; 0: never. */
static int bounces_until_stuck(double restitution, int most)
{
    progress_rate seen = progress_rate_create();
    double t = 1, flight = 0.1;
    for (int i = 1; i <= most; i++) {
        if (!progress_rate_event(&seen, t, progress_rate_resolution(t, 2))) {
            return i;
        }
        t += flight;
        flight *= restitution;
    }
    return 0;
}

static void test_bounces_that_come_to_a_stop_in_time_are_seen(void **unused)
{
    (void)unused;
    /* flights of 0.1 e^i are rounding of the time, 1e-16, from i = ln(1e-15) / ln e on; 1000 more are the most */
    const double restitutions[] = {0.0, 0.5, 0.9, 0.99};
    for (int i = 0; i < 4; i++) {
        const double e = restitutions[i];
        const double free = e > 0 ? log(1e-15) / log(e) : 0;
        const int bounces = bounces_until_stuck(e, 100000);
        assert_in_range(bounces, 1000, 1004 + (int)free);
    }
}

static void test_bounces_that_go_on_are_no_standstill(void **unused)
{
    (void)unused;
    assert_int_equal(bounces_until_stuck(1.0, 100000), 0);
}

static void test_steps_without_progress_are_seen(void **unused)
{
    (void)unused;
    progress_rate seen = progress_rate_create();
    const double grain = progress_rate_resolution(1.0, 1.0);
    int n = 0;
    while (progress_rate_steps(&seen, 1, 1.0, grain)) {
        n++;
    }
    assert_int_equal(n, 100000);
    assert_true(progress_rate_steps(&seen, 1, 1.0 + 2 * grain, grain));
}

static void test_steps_that_creep_within_the_grain_are_no_progress(void **unused)
{
    (void)unused;
    /* what cannot be told from rounding of the time, or from nothing in a run that has only begun */
    assert_true(progress_rate_resolution(0, 2) == 2e-10);
    assert_true(progress_rate_resolution(1e9, 1) == 64 * DBL_EPSILON * 1e9);
    progress_rate seen = progress_rate_create();
    const double grain = progress_rate_resolution(0, 2);
    int n = 0;
    while (n < 200000 && progress_rate_steps(&seen, 1, n * 5e-6 * grain, grain)) {
        n++;
    }
    assert_int_equal(n, 100000); /* they came half a grain far */
}

static void test_progress_makes_room_for_as_many_again(void **unused)
{
    (void)unused;
    progress_rate seen = progress_rate_create();
    const double grain = progress_rate_resolution(1.0, 1.0);
    for (int i_event = 0; i_event < 3; i_event++) {
        for (int i = 0; i < 1000; i++) {
            assert_true(progress_rate_event(&seen, 1.0 + 2 * i_event * grain, grain));
        }
        for (int i = 0; i < 100000; i++) {
            assert_true(progress_rate_steps(&seen, 1, 1.0 + 2 * i_event * grain, grain));
        }
    }
    assert_false(progress_rate_event(&seen, 1.0 + 4 * grain, grain));
    assert_false(progress_rate_steps(&seen, 1, 1.0 + 4 * grain, grain));
}

/* Steps of this length until a run of 1 s has to end, and how; 0: not among the first `tried`. */
static long steps_until(step_budget end, double length, int n, double most, long tried)
{
    progress_rate seen = progress_rate_create();
    for (long i = 1; i <= tried; i++) {
        const step_budget left = progress_rate_spend(&seen, n, (double)i * length, 1, most);
        if (left != BUDGET_FITS) {
            assert_int_equal(left, end);
            return i;
        }
    }
    return 0;
}

static void test_a_run_may_take_so_many_steps(void **unused)
{
    (void)unused;
    assert_int_equal(steps_until(BUDGET_SPENT, 1e-3, 1, 500, 10000), 500);
    assert_int_equal(steps_until(BUDGET_SPENT, 1e-3, 50, 500, 10000), 10); /* IDA makes many at once */
    assert_int_equal(steps_until(BUDGET_SPENT, 0, 1, DBL_MAX, 3000000), 0);
}

static void test_on_a_millionth_of_a_run_it_may_take_a_thousandth_of_them(void **unused)
{
    (void)unused;
    const double most = 4e9; /* 4e6 steps on 1e-6 s */
    assert_int_equal(steps_until(BUDGET_TOO_SLOW, 0.9 * 1e-6 / 4e6, 1, most, 10000000), 4000000);
    assert_int_equal(steps_until(BUDGET_TOO_SLOW, 1.1 * 1e-6 / 4e6, 1, most, 10000000), 0);
    assert_int_equal(steps_until(BUDGET_TOO_SLOW, 0, 1, 2e6, 3000000), 1000000); /* but at least 1e6 */
}

static progress_rate heard(int n, double restitution)
{
    progress_rate seen = progress_rate_create();
    double t = 0, flight = 1;
    for (int i = 0; i < n; i++) {
        progress_rate_note(&seen, t, &impact);
        t += flight;
        flight *= restitution;
    }
    return seen;
}

static void test_events_that_come_ever_sooner_gather(void **unused)
{
    (void)unused;
    double within = 0;
    progress_rate seen = heard(20, 0.5);
    assert_true(progress_rate_accumulates(&seen, &within));
    /* of the 20 the last 9, 8 flights from 0.5^11 on */
    assert_true(fabs(within - (pow(0.5, 10) - pow(0.5, 18))) <= 1e-12);
    seen = heard(20, 1.0);
    assert_false(progress_rate_accumulates(&seen, &within));
    seen = heard(20, 1.1);
    assert_false(progress_rate_accumulates(&seen, &within));
    seen = heard(PROGRESS_RATE_RECENT - 1, 0.5);
    assert_false(progress_rate_accumulates(&seen, &within));
}

static void test_other_events_begin_a_series_anew(void **unused)
{
    (void)unused;
    double within = 0;
    progress_rate seen = heard(PROGRESS_RATE_RECENT, 0.5);
    const dae_event others[] = {{.kind = 4, .subject = 0}, {.kind = 3, .subject = 1}};
    for (int i = 0; i < 2; i++) {
        progress_rate now = seen;
        progress_rate_note(&now, 3, &others[i]);
        assert_int_equal(now.n_recent, 1);
        assert_false(progress_rate_accumulates(&now, &within));
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_bounces_that_come_to_a_stop_in_time_are_seen),
        cmocka_unit_test(test_bounces_that_go_on_are_no_standstill),
        cmocka_unit_test(test_steps_without_progress_are_seen),
        cmocka_unit_test(test_steps_that_creep_within_the_grain_are_no_progress),
        cmocka_unit_test(test_progress_makes_room_for_as_many_again),
        cmocka_unit_test(test_a_run_may_take_so_many_steps),
        cmocka_unit_test(test_on_a_millionth_of_a_run_it_may_take_a_thousandth_of_them),
        cmocka_unit_test(test_events_that_come_ever_sooner_gather),
        cmocka_unit_test(test_other_events_begin_a_series_anew),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
