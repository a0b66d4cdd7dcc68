/* Case after case of one base: a case made in place from the one before is the case that is made anew. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "case/case.h"
#include "case/case_tree.h"
#include "case_entries_at.h"
#include "model/model.h"

enum { MOST_OPTIONS = 4 };

static const char base_text[] =
    "format: 1\n"
    "materials: {steel: {youngs_modulus: 2.0e11, poisson_ratio: 0.3, density: 7800}}\n"
    "wheels:\n"
    "- {name: pinion, teeth: 20, pitch_radius: 0.2, width: 0.1, material: steel, centre: [0, 0],\n"
    "   loads: [{kind: table, time: [0, 1], torque: [-2, -3]}]}\n"
    "- {name: gear, teeth: 30, width: 0.1, material: steel,\n"
    "   support: {kind: slider, direction: 0, mass: 10, stiffness: 1.0e9},\n"
    "   loads: [{kind: viscous, coefficient: 10}]}\n"
    "meshes:\n"
    "- {name: a-b, driving: pinion, driven: gear, driving_rotation: clockwise,\n"
    "   centre_line_angle: 0, pressure_angle: paper_rule}\n"
    "simulation: {duration: 5, output_interval: 1e-3}\n";

typedef const char *row[MOST_OPTIONS];

static int count(const row options)
{
    int n = 0;
    while (n < MOST_OPTIONS && options[n] != NULL) {
        n++;
    }
    return n;
}

static case_base *parse_base(void)
{
    evl_error error;
    case_base *base = case_base_parse("base", base_text, model_schema(), &error);
    assert_non_null(base);
    return base;
}

static void assert_same_case(const case_file *one, const case_file *other)
{
    char *text = tree_text(case_root(one)), *other_text = tree_text(case_root(other));
    assert_string_equal(text, other_text);
    free(text);
    free(other_text);
    assert_same_entries(one, other);
    assert_true(case_description(one)->simulation.tolerance == case_description(other)->simulation.tolerance);
}

/* Each row after the other, beside a case made anew. In place it is made if the case before lives on. */
static void assert_rows(int n, const row *rows, const bool *is_in_place)
{
    case_base *base = parse_base();
    case_file *file = NULL;
    for (int i = 0; i < n; i++) {
        evl_error error, error_anew;
        const case_file *before = file;
        case_file *anew = NULL;
        const bool good = case_override(base, count(rows[i]), rows[i], &file, &error);
        assert_int_equal(case_override(base, count(rows[i]), rows[i], &anew, &error_anew), good);
        if (good) {
            assert_same_case(file, anew);
            assert_int_equal(file == before, is_in_place[i]);
        } else {
            assert_null(anew);
            assert_string_equal(error.location, error_anew.location);
            assert_string_equal(error.message, error_anew.message);
        }
        case_delete(&anew);
    }
    case_delete(&file);
    case_base_delete(&base);
}

#define ASSERT_ROWS(rows, is_in_place) assert_rows((int)(sizeof(rows) / sizeof *(rows)), rows, is_in_place)

static void numbers_of_every_kind_are_exchanged_in_place(void **state)
{
    (void)state;
    static const row rows[] = {
        {"wheels.gear.support.stiffness=1e9", "wheels.0.loads.0.time.1=2", "wheels.pinion.teeth=21",
         "wheels.pinion.centre.1=0.5"},
        {"wheels.gear.support.stiffness=3.25e8", "wheels.0.loads.0.time.1=0.125", "wheels.pinion.teeth=25",
         "wheels.pinion.centre.1=-1"},
        {"materials.steel.density=7000", "simulation.tolerance=1e-7", "meshes.a-b.pressure_angle=20"},
        {"materials.steel.density=7100.5", "simulation.tolerance=1.5e-8", "meshes.a-b.pressure_angle=22.5"},
    };
    static const bool is_in_place[] = {false, true, false, true};
    ASSERT_ROWS(rows, is_in_place);
}

static void what_is_no_number_makes_the_case_anew(void **state)
{
    (void)state;
    static const row rows[] = {
        {"meshes.0.pressure_angle=20", "wheels.gear.support={kind: slider, direction: 1, mass: 1, stiffness: 5}"},
        {"meshes.0.pressure_angle=paper_rule",
         "wheels.gear.support={kind: slider, direction: 1, mass: 1, stiffness: 5}"},
        {"meshes.0.pressure_angle=21", "wheels.gear.support={kind: slider, direction: 1, mass: 1, stiffness: 5}"},
        {"meshes.0.pressure_angle=22", "wheels.gear.support={kind: slider, direction: 1, mass: 1, stiffness: 6}"},
        {"meshes.0.pressure_angle=22"},
        {"meshes.0.pressure_angle=23 # as text"},
    };
    static const bool is_in_place[] = {false, false, true, false, false, false};
    ASSERT_ROWS(rows, is_in_place);
}

static void a_number_with_a_unit_makes_the_case_anew_and_gives_way_to_numbers_in_place(void **state)
{
    (void)state;
    static const row rows[] = {
        {"wheels.gear.support.stiffness=1 kN/mm", "simulation.output_interval=1 ms"},
        {"wheels.gear.support.stiffness=123456789.125", "simulation.output_interval=2e-3"},
        {"wheels.gear.support.stiffness=123456789.125", "simulation.output_interval=6"}, /* said in the key's unit */
        {"wheels.gear.support.stiffness=2 kN/mm", "simulation.output_interval=2e-3"},
        {"wheels.gear.support.stiffness=2 kN/mm", "simulation.output_interval=6 min"},
        {"wheels.gear.support.stiffness=-2 kN/mm", "simulation.output_interval=1 ms"},
        {"wheels.gear.support.stiffness=2 kg", "simulation.output_interval=1 ms"},
    };
    static const bool is_in_place[] = {false, true, false, false, false, false, false};
    ASSERT_ROWS(rows, is_in_place);
}

static void an_option_that_a_later_one_overrules_changes_nothing(void **state)
{
    (void)state;
    static const row rows[] = {
        {"wheels.pinion.teeth=21", "wheels.0.teeth=25"},
        {"wheels.pinion.teeth=22", "wheels.0.teeth=25"},
        {"wheels.pinion.teeth=22", "wheels.0.teeth=26"},
        {"wheels.gear.support.stiffness=1e8", "wheels.gear.support={kind: fixed}"},
        {"wheels.gear.support.stiffness=2e8", "wheels.gear.support={kind: fixed}"},
        {"wheels.gear.support={kind: slider, direction: 0, mass: 1, stiffness: 1}", "wheels.gear.support.mass=2"},
        {"wheels.gear.support={kind: slider, direction: 0, mass: 1, stiffness: 1}", "wheels.gear.support.mass=3"},
    };
    static const bool is_in_place[] = {false, false, true, false, false, false, true};
    ASSERT_ROWS(rows, is_in_place);
}

static void a_refused_number_is_refused_in_the_same_words_and_forgotten(void **state)
{
    (void)state;
    static const row rows[] = {
        {"wheels.pinion.teeth=21", "simulation.output_interval=1e-3"},
        {"wheels.pinion.teeth=2", "simulation.output_interval=1e-3"},
        {"wheels.pinion.teeth=22", "simulation.output_interval=1e-3"},
        {"wheels.pinion.teeth=20.5", "simulation.output_interval=1e-3"},
        {"wheels.pinion.teeth=.nan", "simulation.output_interval=1e-3"},
        {"wheels.pinion.teeth=", "simulation.output_interval=1e-3"},
        {"wheels.pinion.teeth=22", "simulation.output_interval=6"}, /* longer than the duration */
        {"wheels.pinion.teeth=24", "simulation.output_interval=2e-3"},
    };
    static const bool is_in_place[] = {false, false, true, false, false, false, false, true};
    ASSERT_ROWS(rows, is_in_place);
}

/* As a model may refuse it, which names the option. */
static void the_place_of_a_number_is_its_new_option(void **state)
{
    (void)state;
    case_base *base = parse_base();
    case_file *file = NULL;
    evl_error error;
    assert_true(case_override(base, 1, (const row){"wheels.gear.support.stiffness=1e9"}, &file, &error));
    assert_true(case_override(base, 1, (const row){"wheels.gear.support.stiffness=1234567890123456.5"}, &file, &error));
    case_refuse(file, "wheels.gear.support.stiffness", "is too much", &error);
    assert_string_equal(error.location, "--set wheels.gear.support.stiffness=1234567890123456.5");
    case_delete(&file);
    case_base_delete(&base);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(numbers_of_every_kind_are_exchanged_in_place),
        cmocka_unit_test(what_is_no_number_makes_the_case_anew),
        cmocka_unit_test(a_number_with_a_unit_makes_the_case_anew_and_gives_way_to_numbers_in_place),
        cmocka_unit_test(an_option_that_a_later_one_overrules_changes_nothing),
        cmocka_unit_test(a_refused_number_is_refused_in_the_same_words_and_forgotten),
        cmocka_unit_test(the_place_of_a_number_is_its_new_option),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
