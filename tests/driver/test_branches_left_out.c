/* Values that a branch passes without an orbit there are counted: between stable orbits, up to where stability changes. */
#include "respond/branches_points.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

static orbit_point point(double parameter, bool is_stable, model_orbit_kind kind)
{
    return (orbit_point){.orbit = {.parameter = parameter, .is_stable = is_stable, .kind = (int)kind}};
}

static void test_values_between_stable_orbits_count(void **state)
{
    double values[] = {0, 1, 2, 3, 4, 5, 6}, first = NAN;
    orbit_point points[] = {
        point(0, true, MODEL_ORBIT_ORDINARY),    point(1, true, MODEL_ORBIT_ORDINARY),
        point(2.5, true, MODEL_ORBIT_ORDINARY),  /* 2 is missing */
        point(4.5, false, MODEL_ORBIT_FOLD),     /* 3 and 4 */
        point(3.5, false, MODEL_ORBIT_ORDINARY), /* unstable behind the fold: 4 is not wanted */
        point(5.5, false, MODEL_ORBIT_ORDINARY), point(6.5, true, MODEL_ORBIT_ORDINARY), /* 6 may be unstable */
    };
    orbit_branch branch_of[] = {{.n = 2}, {.n = 5}};
    branches branches = {
        .n_values = 7, .values = values, .n_branches = 2, .branches = branch_of, .n_points = 7, .points = points};
    (void)state;
    assert_int_equal(branches_left_out(&branches, 0, &first), 0);
    assert_true(isnan(first));
    assert_int_equal(branches_left_out(&branches, 1, &first), 2);
    assert_true(first == 3);
    branches.branches = (orbit_branch[]){{.n = 7}};
    assert_int_equal(branches_left_out(&branches, 0, &first), 3);
    assert_true(first == 2);
    branches.n_values = 0;
    assert_int_equal(branches_left_out(&branches, 0, &first), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_values_between_stable_orbits_count)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
