/* The case file: what is read, what is refused and where, what --set changes. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#include "base/memory.h"
#include "case/case.h"
#include "case/case_tree.h"
#include "case/former_keys.h"
#include "case_entries_at.h"
#include "model/model.h"

/* Small enough to be written into a line each; the places in the tests count its lines and columns. */
static const char good_case[] = "format: 1\n"
                                "materials: {steel: {youngs_modulus: 2e11, poisson_ratio: 0.3, density: 7800}}\n"
                                "wheels:\n"
                                "- {name: pinion, teeth: 20, pitch_radius: 0.2, width: 0.1, material: steel}\n"
                                "- name: gear\n"
                                "  teeth: 30\n"
                                "  width: 0.1\n"
                                "  material: steel\n"
                                "  support: {kind: slider, direction: 90, stiffness: 1e9}\n"
                                "  loads: [{kind: table, time: [0, 1], torque: [2, 3]}]\n"
                                "meshes:\n"
                                "- {driving: pinion, driven: gear, driving_rotation: clockwise, pressure_angle: 20,\n"
                                "   friction: {law: coulomb, coefficient: 0.1}}\n"
                                "simulation: {duration: 5, output_interval: 1e-3}\n";

static case_file *read_text(const char *text, size_t length, int n_set, const char *const *options, evl_error *error)
{
    FILE *file = fopen("test_case.tmp.yaml", "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(text, 1, length, file), length);
    assert_int_equal(fclose(file), 0);
    case_file *result = case_read("test_case.tmp.yaml", n_set, options, model_schema(), error);
    assert_int_equal(unlink("test_case.tmp.yaml"), 0);
    return result;
}

static case_file *read_good(int n_set, const char *const *options)
{
    evl_error error;
    case_file *file = read_text(good_case, strlen(good_case), n_set, options, &error);
    if (file == NULL) {
        evl_error_print(stderr, &error);
    }
    assert_non_null(file);
    return file;
}

static void assert_refused(const char *text, size_t length, const char *option, evl_exit code, const char *expected)
{
    evl_error error;
    case_file *file = read_text(text, length, option == NULL ? 0 : 1, &option, &error);
    model_message refusal;
    model *model = file == NULL ? NULL : model_create(case_description(file), NULL, NULL, &refusal);
    if (file != NULL && model == NULL) { /* the model knows better what goes together */
        case_refuse(file, refusal.field, refusal.message, &error);
    }
    model_delete(&model);
    case_delete(&file);
    char *line = xasprintf("%s: %s", error.location, error.message);
    if (strstr(line, expected) == NULL || error.code != code) {
        fail_msg("expected %d '%s', got %d '%s'", (int)code, expected, (int)error.code, line);
    }
    free(line);
}

/** good_case with its first `old` replaced. */
static char *edited(const char *old, const char *new)
{
    const char *at = strstr(good_case, old);
    assert_non_null(at);
    return xasprintf("%.*s%s%s", (int)(at - good_case), good_case, new, at + strlen(old));
}

/* ---- what is read ---- */

static void the_papers_case_gives_the_papers_numbers(void **state)
{
    (void)state;
    evl_error error;
    case_file *file = case_read("examples/paper.yaml", 0, NULL, model_schema(), &error);
    assert_non_null(file);
    const description *description = case_description(file);
    assert_true(description->n_wheels == 2 && description->n_meshes == 1 && description->n_shafts == 0);
    assert_string_equal(description->wheels[0], "pinion");
    assert_true(number_at(file, "wheels.pinion.teeth") == 20 && number_at(file, "wheels.pinion.pitch_radius") == 0.2);
    assert_memory_equal(entry_at(file, "wheels.pinion.centre")->numbers, ((const double[]){0, 0}), 2 * sizeof(double));
    assert_string_equal(word_at(file, "wheels.pinion.support.kind"), "fixed");
    assert_string_equal(word_at(file, "wheels.pinion.loads.0.kind"), "torque");
    assert_true(number_at(file, "wheels.pinion.loads.0.value") == -1);
    assert_true(number_at(file, "wheels.gear.teeth") == 30);
    static const char *const open[] = {"pitch_radius", "centre", "inertia", "mass"};
    for (size_t i = 0; i < sizeof open / sizeof *open; i++) {
        char *path = xasprintf("wheels.gear.%s", open[i]);
        assert_null(entry_at(file, path));
        free(path);
    }
    assert_string_equal(word_at(file, "wheels.gear.support.kind"), "slider");
    assert_true(number_at(file, "wheels.gear.support.mass") == 10);
    assert_true(number_at(file, "wheels.gear.support.stiffness") == 1e9);
    assert_true(number_at(file, "wheels.gear.loads.0.coefficient") == 10);
    assert_string_equal(word_at(file, "wheels.gear.material"), "steel");
    assert_true(number_at(file, "materials.steel.youngs_modulus") == 2e11);
    assert_string_equal(word_at(file, "meshes.0.driving"), "pinion");
    assert_string_equal(word_at(file, "meshes.0.driving_rotation"), "clockwise");
    assert_string_equal(word_at(file, "meshes.0.pressure_angle"), "paper_rule");
    assert_true(number_at(file, "meshes.0.centre_line_angle") == 0);
    assert_string_equal(word_at(file, "meshes.0.tracking"), "differential");
    assert_true(number_at(file, "meshes.0.damping.coefficient") == 1e4);
    assert_true(number_at(file, "meshes.0.friction.coefficient") == 0);
    assert_true(number_at(file, "meshes.0.friction.regularisation_velocity") == 1e-4);
    assert_true(description->simulation.duration == 5 && description->simulation.output_interval == 1e-3);
    assert_int_equal(description->simulation.initial.kind, EVL_INITIAL_REST);
    case_delete(&file);
    assert_null(file);
}

static void defaults_are_those_of_the_tables(void **state)
{
    (void)state;
    case_file *file = read_good(0, NULL);
    const description *description = case_description(file);
    assert_string_equal(description->title, "");
    assert_string_equal(description->meshes[0], "pinion-gear");
    assert_string_equal(word_at(file, "meshes.0.tracking"), "closed_form");
    assert_string_equal(word_at(file, "meshes.0.damping.law"), "none");
    assert_true(number_at(file, "meshes.0.friction.regularisation_velocity") == 1e-4);
    assert_null(entry_at(file, "meshes.0.centre_line_angle"));
    assert_null(entry_at(file, "wheels.pinion.loads.0"));
    assert_true(description->simulation.tolerance == 1e-9 && description->simulation.max_step == 0);
    assert_true(description->simulation.initial.gaps[0] == 0);
    assert_null(description->simulation.initial.speeds);
    case_delete(&file);
}

static void the_resolved_text_reads_back_to_itself(void **state)
{
    (void)state;
    static const char *const options[] = {
        "title=\"quotes ' and \\\" \\u00e9\\n second line: - x # no comment\"",
        "simulation.initial={kind: speeds, speeds: {gear: 0.1, pinion: -0.30000000000000004}}",
        "materials.tin={youngs_modulus: 4.14e10, poisson_ratio: .36, density: 7310.}",
        "wheels.gear.loads.1={kind: speed, time: [0, 012, 1e3], speed: [+1, 2, 1.7976931348623157e308]}",
        "wheels.pinion.support={kind: bearing, stiffness: [1e9, 2e-300]}"};
    case_file *first = read_good(5, options);
    evl_error error;
    case_file *second = read_text(case_text(first), strlen(case_text(first)), 0, NULL, &error);
    assert_non_null(second);
    assert_string_equal(case_text(first), case_text(second));
    const description *a = case_description(first), *b = case_description(second);
    assert_string_equal(a->title, "quotes ' and \" \xc3\xa9\n second line: - x # no comment");
    assert_string_equal(a->title, b->title);
    const evl_entry *time = entry_at(first, "wheels.gear.loads.1.time");
    assert_true(time->n == 3 && time->numbers[1] == 12);
    assert_null(entry_at(first, "wheels.gear.loads.1.value"));
    assert_same_entries(first, second);
    assert_memory_equal(a->simulation.initial.speeds, b->simulation.initial.speeds, 2 * sizeof(double));
    case_delete(&first);
    case_delete(&second);
}

static void numbers_of_the_resolved_text_are_numbers_to_yaml_1_1_too(void **state)
{
    (void)state;
    case_file *file = read_good(0, NULL);
    assert_non_null(strstr(case_text(file), "youngs_modulus: 2.0e+11"));
    assert_non_null(strstr(case_text(file), "stiffness: 1.0e+09"));
    case_delete(&file);
}

static void a_table_may_have_a_hundred_thousand_knots(void **state)
{
    (void)state;
    enum { N = 100000 };
    char *option = xcalloc(2 * N, 16);
    size_t n = (size_t)sprintf(option, "wheels.pinion.loads=[{kind: table, time: [");
    for (int i = 0; i < N; i++) {
        n += (size_t)sprintf(option + n, "%d,", i);
    }
    n += (size_t)sprintf(option + n, "], torque: [");
    for (int i = 0; i < N; i++) {
        n += (size_t)sprintf(option + n, "%d,", -i);
    }
    (void)sprintf(option + n, "]}]");
    const char *options[] = {option};
    case_file *file = read_good(1, options);
    const evl_entry *time = entry_at(file, "wheels.pinion.loads.0.time");
    const evl_entry *torque = entry_at(file, "wheels.pinion.loads.0.torque");
    assert_true(time->n == N && torque->n == N);
    assert_true(time->numbers[N - 1] == N - 1 && torque->numbers[N - 1] == 1 - N);
    case_delete(&file);
    free(option);
}

/* ---- --set ---- */

static void set_replaces_adds_and_appends(void **state)
{
    (void)state;
    static const char *const options[] = {"wheels.pinion.teeth=21",
                                          "wheels.1.teeth=33",
                                          "meshes.pinion-gear.friction.coefficient=0.25",
                                          "meshes.0.damping={law: linear, coefficient: 7}",
                                          "wheels.pinion.loads.0={kind: torque, value: -2}",
                                          "wheels.gear.loads.1.kind=viscous",
                                          "wheels.gear.loads.1.coefficient=4",
                                          "simulation.initial.gaps.pinion-gear=1e-6",
                                          "wheels.pinion.teeth=22"};
    case_file *file = read_good(9, options);
    assert_true(number_at(file, "wheels.pinion.teeth") == 22 && number_at(file, "wheels.gear.teeth") == 33);
    assert_true(number_at(file, "meshes.0.friction.coefficient") == 0.25);
    assert_true(number_at(file, "meshes.0.damping.coefficient") == 7);
    assert_true(number_at(file, "wheels.pinion.loads.0.value") == -2);
    assert_true(number_at(file, "wheels.gear.loads.1.coefficient") == 4);
    assert_true(case_description(file)->simulation.initial.gaps[0] == 1e-6);
    case_delete(&file);
}

static void set_on_an_alias_leaves_the_anchor_alone(void **state)
{
    (void)state;
    char *text = edited("{steel: {youngs_modulus: 2e11, poisson_ratio: 0.3, density: 7800}}",
                        "{steel: &s {youngs_modulus: 2e11, poisson_ratio: 0.3, density: 7800}, iron: *s}");
    static const char *const options[] = {"materials.iron.density=7000"};
    evl_error error;
    case_file *file = read_text(text, strlen(text), 1, options, &error);
    assert_non_null(file);
    assert_true(number_at(file, "materials.steel.density") == 7800);
    assert_true(number_at(file, "materials.iron.density") == 7000);
    case_delete(&file);
    free(text);
}

static void refused_options_are_named(void **state)
{
    (void)state;
    static const struct {
        const char *option;
        evl_exit code;
        const char *expected;
    } cases[] = {
        {"wheels.pinion.teeth", EVL_EXIT_USAGE, "--set wheels.pinion.teeth: has no '='"},
        {"=3", EVL_EXIT_USAGE, "has an empty part in its path"},
        {"wheels..teeth=3", EVL_EXIT_USAGE, "has an empty part in its path"},
        {"wheels.pinion.teeth.=3", EVL_EXIT_USAGE, "has an empty part in its path"},
        {"wheels.pinion.teeth=-3", EVL_EXIT_CASE,
         "--set wheels.pinion.teeth=-3: wheels.pinion.teeth: is -3, must be a whole number from 3 to 10000"},
        {"wheels.pinion.teeth=", EVL_EXIT_CASE, "must be a whole number, not nothing"},
        {"wheels.pinion.teeth=[", EVL_EXIT_CASE, "--set wheels.pinion.teeth=[: not valid YAML"},
        {"wheels.piniom.teeth=3", EVL_EXIT_CASE, "wheels has no 'piniom' (did you mean 'pinion'?)"},
        {"wheels.7.teeth=3", EVL_EXIT_CASE, "wheels has no '7'"},
        {"wheels.gear.loads.5.value=3", EVL_EXIT_CASE, "wheels.gear.loads has no element '5'; it has 1"},
        {"whels.0.teeth=3", EVL_EXIT_CASE, "unknown key 'whels' (did you mean 'wheels'?)"},
        {"simulation.duration.x=3", EVL_EXIT_CASE, "simulation.duration is a single value and has no 'x'"},
        {"meshes.0.friction.law=none", EVL_EXIT_CASE,
         "test_case.tmp.yaml:13:29: meshes.pinion-gear.friction: 'coefficient' does not go with "
         "--set meshes.0.friction.law=none; set the whole block"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        assert_refused(good_case, strlen(good_case), cases[i].option, cases[i].code, cases[i].expected);
    }
}

/* ---- what is refused ---- */

static void faults_are_shown_at_their_place(void **state)
{
    (void)state;
    static const struct {
        const char *old, *new, *expected;
    } cases[] = {
        {"teeth: 30", "teeth: 2.5", "yaml:6:10: wheels.gear.teeth: is 2.5, must be a whole number"},
        {"teeth: 30", "teeth: .nan", "yaml:6:10: wheels.gear.teeth: is .nan, which is not a finite number"},
        {"width: 0.1\n", "width: -.inf\n", "yaml:7:10: wheels.gear.width: is -.inf, which is not a finite number"},
        {"width: 0.1\n", "width: 1e999\n", "yaml:7:10: wheels.gear.width: is 1e999, which is not a finite number"},
        {"width: 0.1\n", "width: '0.1'\n", "must be a number [m], not '0.1', which is text because of its quotes"},
        {"width: 0.1\n", "widht: 0.1\n", "yaml:7:3: wheels.gear: unknown key 'widht' (did you mean 'width'?)"},
        {"width: 0.1\n", "colour: 0.1\n", "unknown key 'colour'; known here: name, teeth, pitch_radius"},
        {"  width: 0.1\n", "", "yaml:5:3: wheels.gear: 'width' is missing (face width [m])"},
        {"  width: 0.1\n", "  width: 0.1\n  teeth: 31\n", "yaml:8:3: the key 'teeth' is given twice, first in line 6"},
        {"name: gear", "name: pinion", "the name 'pinion' is given to two wheels"},
        {"name: gear", "name: a.b", "the name 'a.b' contains '.'"},
        {"name: gear", "name: 7", "the name '7' is a number"},
        {"poisson_ratio: 0.3", "poisson_ratio: 0.5", "is 0.5, must be at least 0 and less than 0.5"},
        {"kind: slider", "kind: silder",
         "must be one of fixed, slider, bearing, not 'silder' (did you mean 'slider'?)"},
        {"kind: slider", "kind: fixed", "'direction' is not valid with 'kind: fixed'"},
        {"stiffness: 1e9", "damping: 1", "wheels.gear.support: 'stiffness' is missing"},
        {"[0, 1]", "[1, 1]",
         "yaml:10:35: wheels.gear.loads.0.time: the times of a table must increase: 1 s follows 1 s"},
        {"[2, 3]", "[2]", "wheels.gear.loads.0.torque: has 1 values, but time has 2"},
        {"driven: gear", "driven: geer", "there is no wheel 'geer' (did you mean 'gear'?)"},
        {"driven: gear", "driven: pinion", "driven: a wheel cannot mesh with itself"},
        {"pressure_angle: 20", "pressure_angle: paper", "must be a number [deg] or paper_rule, not 'paper'"},
        {"law: coulomb", "law: coulumb",
         "must be one of none, coulomb, tanh, stribeck, schlenk, mean_roughness, benedict_kelley, xu_kahraman, not "
         "'coulumb' (did you mean 'coulomb'?)"},
        {"coefficient: 0.1", "coefficient: -0.1", "is -0.1, must be at least 0"},
        {"duration: 5", "duration: 0", "is 0 s, must be greater than 0 s"},
        {"output_interval: 1e-3", "output_interval: 6", "is 6 s, longer than the duration of 5 s"},
        {"format: 1", "format: 2", "yaml:1:9: format: is 2, but this evolvent reads format 1 only"},
        {"format: 1\n", "", "'format' is missing"},
        {"  teeth: 30", "\tteeth: 30", "not valid YAML: a tab; indent with spaces"},
        {"teeth: 30", "teeth: !!int 30", "the tag '!!int' has no meaning in a case"},
        {"teeth: 30", "<<: {teeth: 30}", "merge keys (<<) are not supported"},
        {"simulation:", "---\nsimulation:", "a second YAML document"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char *text = edited(cases[i].old, cases[i].new);
        assert_refused(text, strlen(text), NULL, EVL_EXIT_CASE, cases[i].expected);
        free(text);
    }
}

static void what_is_no_case_at_all_is_refused(void **state)
{
    (void)state;
    static const struct {
        const char *text;
        size_t length;
        const char *expected;
    } cases[] = {
        {"", 0, "is empty"},
        {"# only a comment\n", 17, "is empty"},
        {"- 1\n", 4, "must be a block of keys, not a list"},
        {"a: \xff\n", 5, "yaml:1:4: not readable as UTF-8 text"},
        {"\0\1\2", 3, "not readable as UTF-8 text"},
        {"a: [1, 2\n", 9, "yaml:2:1: not valid YAML"},
        {"a: &a [*a]\n", 11, "yaml:1:8: an alias that contains itself"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        assert_refused(cases[i].text, cases[i].length, NULL, EVL_EXIT_CASE, cases[i].expected);
    }
    evl_error error;
    assert_null(case_read("no/such/file.yaml", 0, NULL, model_schema(), &error));
    assert_string_equal(error.location, "no/such/file.yaml");
    assert_string_equal(error.message, "cannot be read: No such file or directory");
    assert_null(case_read("examples", 0, NULL, model_schema(), &error));
    assert_string_equal(error.message, "is a directory, not a case file");
}

static void aliases_that_multiply_are_refused(void **state)
{
    (void)state;
    char *text = xstrdup("a0: &a0 [1, 1, 1, 1, 1, 1, 1, 1, 1, 1]\n");
    for (int i = 1; i < 10; i++) {
        const int k = i - 1;
        char *longer = xasprintf("%sa%d: &a%d [*a%d, *a%d, *a%d, *a%d, *a%d, *a%d, *a%d, *a%d, *a%d, *a%d]\n", text, i,
                                 i, k, k, k, k, k, k, k, k, k, k);
        free(text);
        text = longer;
    }
    assert_refused(text, strlen(text), NULL, EVL_EXIT_CASE, "too many values");
    free(text);
}

static void a_refusal_by_the_model_finds_its_place(void **state)
{
    (void)state;
    static const char *const options[] = {"wheels.pinion.width=0.2"};
    case_file *file = read_good(1, options);
    evl_error error;
    case_refuse(file, "wheels.gear.support.stiffness", "too soft", &error);
    assert_string_equal(error.location, "test_case.tmp.yaml:9:53");
    assert_string_equal(error.message, "wheels.gear.support.stiffness: too soft");
    case_refuse(file, "wheels.pinion.width", "too wide", &error);
    assert_string_equal(error.location, "--set wheels.pinion.width=0.2");
    case_refuse(file, "wheels.gear.pitch_radius", "not known", &error); /* not given: the wheel's place */
    assert_string_equal(error.location, "test_case.tmp.yaml:5:3");
    assert_string_equal(error.message, "wheels.gear.pitch_radius: not known");
    case_refuse(file, "wheels.gear.loads.0.torque", "too high", &error);
    assert_string_equal(error.location, "test_case.tmp.yaml:10:47");
    assert_string_equal(error.message, "wheels.gear.loads.0.torque: too high");
    case_refuse(file, "meshes.pinion-gear", "no solution", &error);
    assert_string_equal(error.location, "test_case.tmp.yaml:12:3");
    assert_string_equal(error.message, "meshes.pinion-gear: no solution");
    case_refuse(file, "simulation.initial.kind", "no steady state", &error);
    assert_string_equal(error.location, "test_case.tmp.yaml:14:13");
    assert_string_equal(error.message, "simulation.initial.kind: no steady state");
    case_refuse(file, "", "out of memory", &error);
    assert_string_equal(error.message, "out of memory");
    assert_int_equal(error.code, EVL_EXIT_CASE);
    case_delete(&file);
}

/* ---- a base that is edited many times ---- */

static const char base_text[] =
    "format: 1\n"
    "materials: {steel: {youngs_modulus: 2.0e11, poisson_ratio: 0.3, density: 7800}}\n"
    "wheels:\n"
    "- {name: pinion, teeth: 20, pitch_radius: 0.2, width: 0.1, material: steel, centre: [0, 0],\n"
    "   loads: [{kind: torque, value: -1}]}\n"
    "- {name: gear, teeth: 30, width: 0.1, material: steel,\n"
    "   loads: [{kind: viscous, coefficient: 10}]}\n"
    "meshes:\n"
    "- {name: a-b, driving: pinion, driven: gear, driving_rotation: clockwise,\n"
    "   centre_line_angle: 0, pressure_angle: paper_rule}\n"
    "simulation: {duration: 5, output_interval: 1e-3}\n";

static void an_edited_base_is_the_case_with_these_options_and_stays_as_it_was(void **state)
{
    (void)state;
    static const char *const options[] = {"wheels.gear.teeth=40", "simulation.duration=2"};
    evl_error error;
    case_base *base = case_base_parse("base", base_text, model_schema(), &error);
    assert_non_null(base);
    for (int i = 0; i < 2; i++) {
        case_file *edited = NULL, *plain = NULL;
        case_file *single = read_text(base_text, strlen(base_text), 2, options, &error);
        assert_true(case_override(base, 2, options, &edited, &error));
        assert_true(case_override(base, 0, NULL, &plain, &error));
        assert_non_null(single);
        assert_true(number_at(edited, "wheels.gear.teeth") == 40);
        assert_true(number_at(single, "wheels.gear.teeth") == 40);
        assert_true(case_description(edited)->simulation.duration == 2);
        assert_true(number_at(plain, "wheels.gear.teeth") == 30);
        assert_true(case_description(plain)->simulation.duration == 5);
        case_delete(&edited);
        case_delete(&plain);
        case_delete(&single);
    }
    case_file *none = NULL;
    assert_false(case_override(base, 1, (const char *const[]){"wheels.gear.teeth=2"}, &none, &error));
    assert_string_equal(error.location, "--set wheels.gear.teeth=2");
    assert_false(case_override(base, 1, (const char *const[]){"simulation=3"}, &none, &error));
    assert_null(none);
    case_base_delete(&base);
}

static void the_elements_of_a_base_are_called_as_paths_call_them(void **state)
{
    (void)state;
    evl_error error;
    memory_arena arena = {NULL};
    int n = 0;
    case_base *base = case_base_parse("base", base_text, model_schema(), &error);
    const char **names = case_base_elements(base, "wheels", &arena, &n);
    assert_int_equal(n, 2);
    assert_string_equal(names[0], "pinion");
    assert_string_equal(names[1], "gear");
    (void)case_base_elements(base, "shafts_of_gold", &arena, &n);
    assert_int_equal(n, 0);
    arena_free(&arena);
    case_base_delete(&base);
}

static void a_path_is_known_if_some_variant_of_its_block_has_the_key(void **state)
{
    (void)state;
    static const char *const good[] = {"wheels.pinion.teeth",
                                       "wheels.1.support.stiffness",
                                       "wheels.gear.centre.0",
                                       "wheels.gear.loads.1.time",
                                       "materials.brass.density",
                                       "meshes.a-b.friction",
                                       "simulation.initial.speeds.gear",
                                       "housing.mount.stiffness"};
    static const char *const bad[] = {"wheels.pinion.tooth",   "wheels.2x.teeth",     "weels.0.teeth",
                                      "wheels.gear.loads.0.x", "materials.steel.rho", "meshes.0.friction.law.x.y.z."};
    evl_error error;
    case_base *base = case_base_parse("base", base_text, model_schema(), &error);
    for (size_t i = 0; i < sizeof good / sizeof *good; i++) {
        assert_true(case_base_has_path(base, good[i], &error));
    }
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        assert_false(case_base_has_path(base, bad[i], &error));
        assert_true(error.message[0] != '\0');
    }
    case_base_delete(&base);
}

static void former_keys_of_a_resolved_text_are_replaced_by_the_present_ones(void **state)
{
    (void)state;
    char *text = xstrdup("case 3 of the design 1f\ntitle: 'runout: of numbers'\nwheels:\n- name: runout\n"
                         "  runout: {amount: 8.0e-06, phase: 0}\n  runouts: 1\nsimulation:\n  duration: 1\n"
                         "  numbers: {from: 0.01}");
    case_text_use_present_keys(&text);
    assert_string_equal(text, "case 3 of the design 1f\ntitle: 'runout: of numbers'\nwheels:\n- name: runout\n"
                              "  eccentricity: {amount: 8.0e-06, phase: 0}\n  runouts: 1\nsimulation:\n  duration: 1\n"
                              "  metrics: {from: 0.01}");
    free(text);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_papers_case_gives_the_papers_numbers),
        cmocka_unit_test(defaults_are_those_of_the_tables),
        cmocka_unit_test(the_resolved_text_reads_back_to_itself),
        cmocka_unit_test(former_keys_of_a_resolved_text_are_replaced_by_the_present_ones),
        cmocka_unit_test(numbers_of_the_resolved_text_are_numbers_to_yaml_1_1_too),
        cmocka_unit_test(a_table_may_have_a_hundred_thousand_knots),
        cmocka_unit_test(set_replaces_adds_and_appends),
        cmocka_unit_test(set_on_an_alias_leaves_the_anchor_alone),
        cmocka_unit_test(refused_options_are_named),
        cmocka_unit_test(faults_are_shown_at_their_place),
        cmocka_unit_test(what_is_no_case_at_all_is_refused),
        cmocka_unit_test(aliases_that_multiply_are_refused),
        cmocka_unit_test(a_refusal_by_the_model_finds_its_place),
        cmocka_unit_test(an_edited_base_is_the_case_with_these_options_and_stays_as_it_was),
        cmocka_unit_test(the_elements_of_a_base_are_called_as_paths_call_them),
        cmocka_unit_test(a_path_is_known_if_some_variant_of_its_block_has_the_key),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
