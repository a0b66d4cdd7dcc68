/* Every number that an example gives, set through the C interface of the kernel and the gearbox made anew, gives the bits of a case
 * that was written so. */
#include <dirent.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "base/memory.h"
#include "base/number.h"
#include "case/case.h"
#include "model/model.h"
#include "wheel_stand_in.h"

#include <evolvent/kernel.h>

/** What shows every number of a gearbox: its sizes, warnings, and all outputs of its first state and of one that moves. */
typedef struct {
    int code, n;
    char message[EVL_MESSAGE_LENGTH];
    double *values;
} portrait;

static void add_outputs(const evl_gearbox *gearbox, const evl_sizes *sizes, double t, const double *y,
                        const int *integers, const double *reals, portrait *portrait)
{
    const int n = sizes->n_values;
    portrait->values = xrealloc(portrait->values, (size_t)(portrait->n + n), sizeof(double));
    evl_status status;
    (void)evl_gearbox_outputs(gearbox, t, y, integers, reals, false, portrait->values + portrait->n, &status);
    portrait->n += n;
}

static portrait portray(const evl_description *description, const evl_initial *initial, const evl_wheel_store *store)
{
    evl_status status = {0};
    portrait portrait = {0};
    evl_gearbox *gearbox = evl_gearbox_create(description, store, &status);
    portrait.code = status.code;
    (void)snprintf(portrait.message, sizeof portrait.message, "%s", status.message);
    if (gearbox == NULL) {
        return portrait;
    }
    evl_sizes sizes;
    evl_gearbox_sizes(gearbox, &sizes);
    double *y = xcalloc((size_t)sizes.n_states, sizeof *y), *yp = xcalloc((size_t)sizes.n_states, sizeof *yp);
    int *integers = xcalloc((size_t)sizes.n_integers, sizeof *integers);
    double *reals = xcalloc((size_t)sizes.n_reals, sizeof *reals);
    portrait.code = evl_gearbox_initial_state(gearbox, initial, 0, y, yp, integers, reals, &status);
    if (portrait.code == EVL_OK) {
        add_outputs(gearbox, &sizes, 0, y, integers, reals, &portrait);
        for (int i = 0; i < sizes.n_states; i++) {
            y[i] += 1e-7 * (1 + i % 3);
        }
        add_outputs(gearbox, &sizes, 0.01, y, integers, reals, &portrait);
    }
    free(reals);
    free(integers);
    free(yp);
    free(y);
    evl_gearbox_delete(&gearbox);
    return portrait;
}

static void assert_alike(const char *path, const portrait *a, const portrait *b)
{
    if (a->code != b->code || strcmp(a->message, b->message) != 0 || a->n != b->n ||
        memcmp(a->values == NULL ? "" : (const char *)a->values, b->values == NULL ? "" : (const char *)b->values,
               (size_t)a->n * sizeof(double)) != 0) {
        fail_msg("%s: set and written are not the same (%d %s, %d %s)", path, a->code, a->message, b->code, b->message);
    }
}

/** The example's start; with compliance only at first, since a steady one takes long and shows no other numbers than rest. */
static evl_initial initial_of(const case_file *file, const evl_wheel_store *store)
{
    const bool is_compliant = ((const wheel_stand_in *)store->self)->numbers != NULL;
    return is_compliant ? (evl_initial){.kind = EVL_INITIAL_REST} : case_description(file)->simulation.initial;
}

/** Another number that the row accepts, if there is one near. */
static double other_number(const evl_row *row, double value)
{
    if (row->type == EVL_INTEGER) {
        return value + 1 <= row->maximum ? value + 1 : value - 1;
    }
    const double more = value == 0 ? (row->maximum > 0 ? 1e-7 : -1e-7) : value * (1 + 1e-4);
    return more <= row->maximum && more >= row->minimum ? more : value * (1 - 1e-4);
}

static char *option_of(const char *path, int n, const double *numbers)
{
    char *option = xasprintf("%s=%s", path, n == 1 ? "" : "[");
    for (int i = 0; i < n; i++) {
        char number[NUMBER_TEXT_LENGTH];
        number_write(number, numbers[i]);
        char *longer = xasprintf("%s%s%s", option, i == 0 ? "" : ", ", number);
        free(option);
        option = longer;
    }
    char *whole = xasprintf("%s%s", option, n == 1 ? "" : "]");
    free(option);
    return whole;
}

/** Compare what setting a parameter gives with a case that says so. @return whether the case could be written so */
static bool check_parameter(const char *example, const evl_wheel_store *store, evl_description *description, int index,
                            const evl_row *row, const char *path, int n, const double *numbers)
{
    double *others = memcpy(xcalloc((size_t)n, sizeof *others), numbers, (size_t)n * sizeof *others);
    others[n - 1] = other_number(row, numbers[n - 1]);
    char *option = option_of(path, n, others);
    evl_error error;
    case_file *file = case_read(example, 1, (const char *const[]){option}, model_schema(), &error);
    const bool is_written = file != NULL;
    if (is_written) {
        evl_status status;
        const evl_initial initial = initial_of(file, store);
        evl_description *written =
            evl_description_create(case_description(file)->n_entries, case_description(file)->entries, &status);
        assert_non_null(written);
        assert_int_equal(evl_description_set(description, index, others, &status), EVL_OK);
        portrait a = portray(description, &initial, store), b = portray(written, &initial, store);
        assert_alike(option, &a, &b);
        free(a.values);
        free(b.values);
        assert_int_equal(evl_description_set(description, index, numbers, &status), EVL_OK);
        evl_description_delete(&written);
    }
    case_delete(&file);
    free(option);
    free(others);
    return is_written;
}

static int check_example(const char *example)
{
    evl_error error;
    evl_status status;
    case_file *file = case_read(example, 0, NULL, model_schema(), &error);
    assert_non_null(file);
    evl_description *description =
        evl_description_create(case_description(file)->n_entries, case_description(file)->entries, &status);
    assert_non_null(description);
    evl_parameter parameter;
    wheel_stand_in wheel = {0};
    const evl_wheel_store store = wheel_stand_in_store(&wheel);
    int checked = 0;
    for (int i = 0; evl_description_parameter(description, i, &parameter, 0, NULL); i++) {
        double *numbers = xcalloc((size_t)parameter.n, sizeof *numbers);
        (void)evl_description_parameter(description, i, &parameter, parameter.n, numbers);
        checked += check_parameter(example, &store, description, i, &model_schema()->rows[parameter.row],
                                   parameter.path, parameter.n, numbers);
        free(numbers);
    }
    wheel_stand_in_free(&wheel);
    evl_description_delete(&description);
    case_delete(&file);
    return checked;
}

static void every_number_of_every_example_can_be_set(void **state)
{
    (void)state;
    DIR *folder = opendir("examples");
    assert_non_null(folder);
    int examples = 0, checked = 0;
    for (struct dirent *entry = readdir(folder); entry != NULL; entry = readdir(folder)) {
        const char *end = strrchr(entry->d_name, '.');
        const bool is_plan = strstr(entry->d_name, "sweep") != NULL;
        if (end == NULL || strcmp(end, ".yaml") != 0 || is_plan) {
            continue;
        }
        char *path = xasprintf("examples/%s", entry->d_name);
        checked += check_example(path);
        examples++;
        free(path);
    }
    (void)closedir(folder);
    assert_true(examples >= 9 && checked > 30 * examples);
}

static void a_number_out_of_range_is_refused_and_the_old_one_kept(void **state)
{
    (void)state;
    evl_error error;
    evl_status status;
    case_file *file = case_read("examples/paper.yaml", 0, NULL, model_schema(), &error);
    evl_description *description =
        evl_description_create(case_description(file)->n_entries, case_description(file)->entries, &status);
    evl_parameter parameter;
    int width = 0;
    while (evl_description_parameter(description, width, &parameter, 0, NULL) &&
           strcmp(parameter.path, "wheels.pinion.width") != 0) {
        width++;
    }
    assert_string_equal(parameter.unit, "m");
    double now = 0;
    assert_int_equal(evl_description_set(description, width, &(double){-1.0}, &status), EVL_INVALID_INPUT);
    assert_string_equal(status.message, "width = -1 m must be greater than 0 m");
    char path[EVL_PATH_LENGTH];
    evl_description_path(description, &status, path);
    assert_string_equal(path, "wheels.pinion.width");
    (void)evl_description_parameter(description, width, &parameter, 1, &now);
    assert_true(now == 0.1);
    evl_description_delete(&description);
    case_delete(&file);
}

/** Renew a description of a case by its entries, of which one is another now. @return whether the kernel took it */
static bool renew(const description *whole, int index, evl_entry other)
{
    evl_status status;
    const size_t n = (size_t)whole->n_entries;
    evl_description *made = evl_description_create(whole->n_entries, whole->entries, &status);
    evl_entry *entries = memcpy(xcalloc(n, sizeof *entries), whole->entries, n * sizeof *entries);
    entries[index] = other;
    const bool good = evl_description_renew(made, whole->n_entries, entries);
    free(entries);
    evl_description_delete(&made);
    return good;
}

static void a_description_is_renewed_by_entries_that_differ_in_good_numbers_only(void **state)
{
    (void)state;
    evl_error error;
    evl_status status;
    case_file *file = case_read("examples/tutorial-train.yaml", 0, NULL, model_schema(), &error);
    assert_non_null(file);
    const description *whole = case_description(file);
    int n_refused = 0;
    for (int i = 0; i < whole->n_entries; i++) {
        const evl_entry own = whole->entries[i];
        const evl_row *row = &model_schema()->rows[own.row];
        evl_entry other = own;
        double numbers[8] = {0};
        assert_true(renew(whole, i, own));
        other.row = own.row == 0 ? 1 : own.row - 1;
        assert_false(renew(whole, i, other));
        other = own;
        other.level++;
        assert_false(renew(whole, i, other));
        other = own;
        other.name = own.name == NULL || own.name[0] == '\0' ? "x" : "";
        assert_false(renew(whole, i, other));
        other.name = own.name == NULL || own.name[0] == '\0' ? NULL : own.name + 1;
        assert_int_equal(renew(whole, i, other), other.name == NULL);
        if (own.n == 0 || own.n >= 8) {
            continue;
        }
        memcpy(numbers, own.numbers, (size_t)own.n * sizeof *numbers);
        other = own;
        other.numbers = numbers;
        other.n++;
        assert_false(renew(whole, i, other));
        other.n = own.n;
        numbers[own.n - 1] = NAN;
        assert_false(renew(whole, i, other));
        numbers[own.n - 1] = row->minimum - 1;
        assert_int_equal(renew(whole, i, other), false);
        numbers[own.n - 1] = row->maximum + 1;
        assert_int_equal(renew(whole, i, other), false);
        n_refused += isfinite(row->minimum) + isfinite(row->maximum);
    }
    assert_true(n_refused > 30);
    evl_description *made = evl_description_create(whole->n_entries, whole->entries, &status);
    assert_false(evl_description_renew(made, whole->n_entries - 1, whole->entries));
    evl_description_delete(&made);
    case_delete(&file);
}

/** Paths of what the kernel says, however it is numbered there. */
static void every_message_of_the_kernel_finds_its_place(void **state)
{
    (void)state;
    static const char *const options[] = {
        "shafts=[{name: long, wheels: [pinion, gear], kind: rigid}]", "wheels.gear.loads.1={kind: torque, value: 1}",
        "simulation.initial={kind: speeds, speeds: {pinion: 1, gear: 1}, gaps: {pinion-gear: 1e-6}}"};
    static const struct {
        int subject, index;
        const char *field, *path;
    } rows[] = {
        {EVL_SUBJECT_NONE, -1, "", ""},
        {EVL_SUBJECT_WHEEL, 1, "", "wheels.gear"},
        {EVL_SUBJECT_WHEEL, 1, "width", "wheels.gear.width"},
        {EVL_SUBJECT_LOAD, 2, "", "wheels.gear.loads.1"},
        {EVL_SUBJECT_LOAD, 0, "value", "wheels.pinion.loads.0.value"},
        {EVL_SUBJECT_MESH, 0, "", "meshes.pinion-gear"},
        {EVL_SUBJECT_SHAFT, 0, "stiffness", "shafts.long.stiffness"},
        {EVL_SUBJECT_INITIAL, -1, "", "simulation.initial"},
        {EVL_SUBJECT_HOUSING, -1, "", "housing"},
        {EVL_SUBJECT_WHEEL, 1, "speeds", "simulation.initial.speeds.gear"},
        {EVL_SUBJECT_MESH, 0, "gaps", "simulation.initial.gaps.pinion-gear"},
    };
    evl_error error;
    evl_status status;
    case_file *file = case_read("examples/paper.yaml", 3, options, model_schema(), &error);
    assert_non_null(file);
    evl_description *description =
        evl_description_create(case_description(file)->n_entries, case_description(file)->entries, &status);
    assert_non_null(description);
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        char path[EVL_PATH_LENGTH];
        status = (evl_status){.code = EVL_INVALID_INPUT, .subject = rows[i].subject, .index = rows[i].index};
        (void)snprintf(status.field, sizeof status.field, "%s", rows[i].field);
        evl_description_path(description, &status, path);
        assert_string_equal(path, rows[i].path);
    }
    evl_description_delete(&description);
    case_delete(&file);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_number_of_every_example_can_be_set),
        cmocka_unit_test(a_number_out_of_range_is_refused_and_the_old_one_kept),
        cmocka_unit_test(a_description_is_renewed_by_entries_that_differ_in_good_numbers_only),
        cmocka_unit_test(every_message_of_the_kernel_finds_its_place),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
