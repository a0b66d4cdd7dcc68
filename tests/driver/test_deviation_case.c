/* Deviations of flanks as the description has them: SI units and radians, nothing where nothing is said. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include <cmocka.h>

#include "case/case.h"
#include "load_kinds.h"

static const kind_info contact_laws[] = {{.name = "johnson", .text = "a contact"}};
static const kind_info other_laws[] = {{.name = "none", .text = "nothing"}};
static const law_tables laws = {.count = {1, 1, 1},
                                .laws = {contact_laws, other_laws, other_laws},
                                .n_loads = LOAD_KINDS,
                                .loads = load_kinds,
                                .n_supports = SUPPORT_KINDS,
                                .supports = support_kinds};

/** The case of tip relief with the laws of this test. */
static case_file *read_example(int n_set, const char *const *set)
{
    const char *options[8] = {"meshes.0.damping={law: none}", "meshes.0.friction={law: none}"};
    for (int i = 0; i < n_set; i++) {
        options[2 + i] = set[i];
    }
    evl_error error;
    case_file *file = case_read("examples/tip-relief.yaml", n_set + 2, options, &laws, &error);
    if (file == NULL) {
        evl_error_print(stderr, &error);
    }
    assert_non_null(file);
    return file;
}

static void a_key_that_stays_away_means_no_deviation(void **state)
{
    (void)state;
    case_file *file = read_example(0, NULL);
    const deviation_description *pinion = &case_description(file)->wheels[0].deviation;
    assert_true(pinion->tip_relief.amount == 12e-6 && pinion->tip_relief.start == 0.0615);
    assert_true(pinion->tip_relief.is_parabolic && !pinion->tip_relief.by_roll_angle);
    assert_true(pinion->root_relief.amount == 0 && pinion->profile_crowning == 0);
    assert_int_equal(pinion->n_pitch_errors, 0);
    assert_null(pinion->pitch_errors);
    assert_true(pinion->accuracy_class == 5 && pinion->seed == 1);
    assert_true(pinion->runout_amount == 0 && pinion->runout_phase == 0);
    case_delete(&file);
}

static void every_key_arrives_and_angles_are_radians(void **state)
{
    (void)state;
    const char *const set[] = {"wheels.gear.tip_relief={amount: 3e-6, roll_angle: 30}",
                               "wheels.gear.root_relief={amount: 2e-6, diameter: 0.085, shape: parabolic}",
                               "wheels.gear.profile_crowning=1e-6", "wheels.gear.pitch_errors=[1e-6, -2e-6]",
                               "wheels.gear.runout={amount: 5e-6, phase: -90}"};
    case_file *file = read_example(5, set);
    const deviation_description *gear = &case_description(file)->wheels[1].deviation;
    assert_true(gear->tip_relief.amount == 3e-6 && gear->tip_relief.by_roll_angle);
    /* 30 degrees; the conversion rounds */
    assert_true(gear->tip_relief.start > 0.52359877559829 && gear->tip_relief.start < 0.52359877559831);
    assert_true(!gear->tip_relief.is_parabolic);
    assert_true(gear->root_relief.amount == 2e-6 && gear->root_relief.start == 0.085);
    assert_true(gear->root_relief.is_parabolic && !gear->root_relief.by_roll_angle);
    assert_true(gear->profile_crowning == 1e-6);
    assert_int_equal(gear->n_pitch_errors, 2);
    assert_true(gear->pitch_errors[0] == 1e-6 && gear->pitch_errors[1] == -2e-6);
    assert_true(gear->runout_amount == 5e-6);
    assert_true(gear->runout_phase > -1.5707963267949 && gear->runout_phase < -1.5707963267948);
    case_delete(&file);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_key_that_stays_away_means_no_deviation),
        cmocka_unit_test(every_key_arrives_and_angles_are_radians),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
