/* The climber on functions whose maxima are known. */
#include "base/peak.h"

#include <float.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

enum { MOST_CALLS = 19 }; /* at the start, and three a turn */

/* What the climber asked, as a caller keeps it. */
typedef struct {
    double (*function)(double t);
    double left, right; /* asked outside, the test fails */
    double largest, at;
    int n_calls;
} climb;

static double ask(void *with, double t)
{
    climb *c = with;
    assert_true(t >= c->left && t <= c->right);
    const double value = c->function(t);
    if (c->n_calls++ == 0 || value > c->largest) {
        c->largest = value;
        c->at = t;
    }
    return value;
}

static climb climbed(double (*function)(double t), const peak_bracket *bracket)
{
    climb c = {.function = function, .left = bracket->left, .right = bracket->right};
    peak_climb(ask, &c, bracket);
    assert_in_range(c.n_calls, 1, MOST_CALLS);
    return c;
}

/* From a start in a bracket, nothing expected and everything wanted. */
static climb from(double (*function)(double t), double left, double start, double right)
{
    const peak_bracket bracket = {left, right, start, 0.05 * (right - left), NAN, -INFINITY};
    return climbed(function, &bracket);
}

static double parabola(double t)
{
    return 2 - 3 * (t - 0.4) * (t - 0.4);
}

static double cubic(double t) /* largest at -1: 2; bends up from 0 on */
{
    return t * t * t - 3 * t;
}

static double quartic(double t) /* largest at +-1: 1; smallest between them at 0 */
{
    return t * t * (2 - t * t);
}

static double flat_top(double t) /* without curvature at its maximum, 1 at 0.3 */
{
    return 1 - pow(t - 0.3, 4);
}

static double rising(double t)
{
    return -exp(-t);
}

static double falling(double t)
{
    return -exp(t);
}

static double bent_up(double t)
{
    return exp(t);
}

static double straight(double t)
{
    return 3 * t;
}

static double flat(double t)
{
    (void)t;
    return 7;
}

static double unknown_beside(double t)
{
    return t < 0.5 || t > 0.5 ? NAN : 1;
}

static void the_vertex_of_a_parabola_is_exact(void **state)
{
    (void)state;
    const double t[3] = {-0.7, 0.1, 2};
    const double f[3] = {parabola(t[0]), parabola(t[1]), parabola(t[2])}, minus[3] = {-f[0], -f[1], -f[2]};
    assert_true(fabs(peak_of_parabola(t, f) - 0.4) <= 4 * DBL_EPSILON);
    assert_true(isnan(peak_of_parabola(t, minus)));
    assert_true(isnan(peak_of_parabola(t, (const double[3]){5, 5, 5})));
    assert_true(isnan(peak_of_parabola(t, (const double[3]){5, NAN, 5})));
}

static void a_width_beyond_the_bracket_is_what_fits(void **state)
{
    (void)state;
    static const double starts[] = {0, 0.2, 0.5, 0.9, 1};
    for (int i = 0; i < 5; i++) {
        const peak_bracket bracket = {0, 1, starts[i], 10, NAN, -INFINITY};
        /* the vertex of a parabola is exact, from any three places */
        assert_true(fabs(climbed(parabola, &bracket).largest - 2) <= 8 * DBL_EPSILON);
    }
}

static void a_maximum_inside_is_found(void **state)
{
    (void)state;
    const struct {
        double (*function)(double t);
        double left, start, right, at, largest;
    } cases[] = {
        {parabola, 0, 0.9, 1, 0.4, 2},    {parabola, 0, 0, 1, 0.4, 2},    {cubic, -1.5, -0.7, -0.2, -1, 2},
        {cubic, -1.2, -1.2, -0.5, -1, 2}, {quartic, 0.6, 1.3, 1.5, 1, 1}, {quartic, -1.4, -0.85, -0.6, -1, 1},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const climb c = from(cases[i].function, cases[i].left, cases[i].start, cases[i].right);
        /* what another turn would gain is 1e-12 of the value; a place is as exact as the root of that */
        assert_true(fabs(c.largest - cases[i].largest) <= 1e-12 * cases[i].largest);
        assert_true(fabs(c.at - cases[i].at) <= 1e-6);
    }
}

/* Parabolas come nearer to a maximum without curvature by a third of the way each turn. */
static void a_maximum_without_curvature_is_come_near(void **state)
{
    (void)state;
    const climb c = from(flat_top, 0, 0.8, 1);
    assert_true(c.largest > 1 - 1e-3 * (1 - flat_top(0.8)));
}

static void a_maximum_at_an_end_is_that_end(void **state)
{
    (void)state;
    const climb right = from(rising, 0, 0.3, 1), left = from(falling, 0, 0.6, 1), at = from(falling, 0, 0, 1);
    assert_true(right.at == 1 && right.largest == rising(1));
    assert_true(left.at == 0 && left.largest == falling(0));
    assert_true(at.at == 0 && at.largest == falling(0));
}

/* The start has to be near the maximum: here the first parabola leads past it, to the end. */
static void a_start_from_which_a_parabola_leads_lower_ends_the_search(void **state)
{
    (void)state;
    const climb c = from(quartic, -1.4, -0.7, -0.6);
    assert_int_equal(c.n_calls, 4);
    assert_true(c.largest >= quartic(-0.7) && c.largest < 1);
}

/* The ends of a bracket are the caller's: where nothing bends down there is nothing to climb. */
static void what_does_not_bend_down_ends_the_search(void **state)
{
    (void)state;
    double (*const functions[])(double t) = {bent_up, straight, flat, unknown_beside};
    for (size_t i = 0; i < sizeof functions / sizeof *functions; i++) {
        const climb c = from(functions[i], 0, 0.5, 1);
        assert_int_equal(c.n_calls, 3);
        assert_true(c.largest >= functions[i](0.5));
    }
}

static void a_bracket_without_length_is_asked_once(void **state)
{
    (void)state;
    const climb c = from(parabola, 0.3, 0.3, 0.3);
    assert_int_equal(c.n_calls, 1);
    assert_true(c.at == 0.3);
}

static void what_stays_below_the_wanted_is_not_climbed(void **state)
{
    (void)state;
    peak_bracket bracket = {0, 1, 0.5, 0.05, NAN, 2.5}; /* 1.97 there, 2 at most */
    assert_int_equal(climbed(parabola, &bracket).n_calls, 1);
    bracket.threshold = 1.9;
    assert_true(climbed(parabola, &bracket).n_calls > 1);
    /* the start is as far from what was expected as the peak may be from the start, three times */
    bracket.threshold = 2.5;
    bracket.expected = 2.4;
    assert_true(climbed(parabola, &bracket).n_calls > 1);
    bracket.expected = 1.98;
    assert_int_equal(climbed(parabola, &bracket).n_calls, 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_vertex_of_a_parabola_is_exact),
        cmocka_unit_test(a_width_beyond_the_bracket_is_what_fits),
        cmocka_unit_test(a_maximum_inside_is_found),
        cmocka_unit_test(a_maximum_without_curvature_is_come_near),
        cmocka_unit_test(a_maximum_at_an_end_is_that_end),
        cmocka_unit_test(a_start_from_which_a_parabola_leads_lower_ends_the_search),
        cmocka_unit_test(what_does_not_bend_down_ends_the_search),
        cmocka_unit_test(a_bracket_without_length_is_asked_once),
        cmocka_unit_test(what_stays_below_the_wanted_is_not_climbed),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
