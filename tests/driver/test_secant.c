/* Zeros between two places: against closed forms, by few evaluations, never outside. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "base/secant.h"

typedef struct {
    double (*of)(double t);
    double first, last; /* where it was asked */
    int n;
} asked;

static double ask(void *self, double t)
{
    asked *a = self;
    a->first = fmin(a->first, t);
    a->last = fmax(a->last, t);
    a->n++;
    return a->of(t);
}

static double cube(double t)
{
    return t * t * t - 2;
}

static double crossing(double t)
{
    return cos(t) - t;
}

static double growing(double t)
{
    return exp(t) - 5;
}

/* Flat at one end: a secant that keeps the other end crawls. */
static double flat(double t)
{
    return pow(t, 9) - 0.1;
}

static void a_zero_is_that_of_the_closed_form_from_both_sides(void **state)
{
    (void)state;
    static const double close = 1e-13;
    const struct {
        double (*of)(double t);
        double from, to, zero;
    } cases[] = {{cube, 0, 2, cbrt(2)},
                 {crossing, 0, 1, 0.73908513321516064},
                 {growing, -3, 3, log(5)},
                 {flat, 0, 1.5, pow(0.1, 1.0 / 9)}};
    for (int i = 0; i < 8; i++) {
        const double ends[] = {cases[i / 2].from, cases[i / 2].to};
        const double a = ends[i % 2], b = ends[1 - i % 2];
        asked asked = {.of = cases[i / 2].of, .first = INFINITY, .last = -INFINITY};
        const double zero = secant_zero(ask, &asked, a, asked.of(a), b, asked.of(b), close);
        assert_true(fabs(asked.of(zero)) <= close);
        assert_true(fabs(zero - cases[i / 2].zero) <= close); /* all are steeper than 1 there */
        assert_true(asked.first >= ends[0] && asked.last <= ends[1]);
        /* of order 1.44, Dowell and Jarratt 1971: six evaluations or so in the end, more while it is far */
        assert_true(asked.n <= 25);
    }
}

static void a_straight_line_takes_one_secant(void **state)
{
    (void)state;
    asked asked = {.of = cube, .first = INFINITY, .last = -INFINITY};
    const double zero = secant_zero(ask, &asked, cbrt(2) - 1e-9, -3e-9, cbrt(2) + 1e-9, 3e-9, 1e-8);
    assert_int_equal(asked.n, 1);
    assert_true(fabs(zero - cbrt(2)) <= 1e-15);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_zero_is_that_of_the_closed_form_from_both_sides),
        cmocka_unit_test(a_straight_line_takes_one_secant),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
