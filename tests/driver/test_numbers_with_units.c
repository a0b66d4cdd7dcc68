/* Every row of the schema that holds numbers, in every variant, takes all units of its kind and refuses the units of the others. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "base/number.h"
#include "case/case_check.h"
#include "case/unit.h"
#include "model/model.h"

/** So many numbers of a text, as the type of the row wants them. */
static case_node *node_of(const evl_row *row, const char *text, memory_arena *arena)
{
    static const int components[] = {[EVL_PAIR] = 2,  [EVL_TRIPLE] = 3,   [EVL_QUATERNION] = 4, [EVL_SERIES] = 3,
                                     [EVL_KNOTS] = 2, [EVL_AT_KNOTS] = 2, [EVL_NAMED] = 2};
    const case_location location = {.line = 1, .column = 1};
    if (row->type == EVL_NUMBER || row->type == EVL_INTEGER) {
        return node_create_scalar(arena, text, true, location);
    }
    case_node *node = node_create(arena, row->type == EVL_NAMED ? NODE_MAPPING : NODE_SEQUENCE, location);
    for (int i = 0; i < components[row->type]; i++) {
        const char *key = row->type == EVL_NAMED ? (i == 0 ? "a" : "b") : NULL;
        node_append(node, key, location, node_create_scalar(arena, text, true, location));
    }
    return node;
}

static bool check_text(const evl_row *row, const char *text, memory_arena *arena, case_node **node, evl_error *error)
{
    const checker root = {.schema = model_schema(), .path = "case.yaml", .error = error};
    const struct checker inner = checker_at(&root, row->key);
    memset(error, 0, sizeof *error);
    *node = node_of(row, text, arena);
    return check_single_value(&inner, row, *node);
}

/** Call for each row that holds numbers, the whole numbers being others. */
static void with_each_row(void (*call)(const evl_row *row))
{
    const case_schema *schema = model_schema();
    int n = 0;
    for (int i = 0; i < schema->n; i++) {
        if (schema->rows[i].type <= EVL_NAMED && schema->rows[i].type != EVL_INTEGER) {
            call(&schema->rows[i]);
            n++;
        }
    }
    assert_true(n > 100);
}

/** A number that the row takes. */
static double number_within(const evl_row *row)
{
    const double low = isfinite(row->minimum) ? row->minimum : fmin(row->maximum - 1, 0);
    const double high = isfinite(row->maximum) ? row->maximum : low + 1;
    return isfinite(high) ? low + (high - low) * 0.375 : 0.375;
}

static const case_node *first_number(const case_node *node)
{
    return node->kind == NODE_SCALAR ? node : node->entries[0].value;
}

static void take_each_unit(const evl_row *row)
{
    ARENA_SCOPE memory_arena arena = {NULL};
    int n = 0;
    const char **spellings = unit_spellings(row->unit, &arena, &n);
    for (int i = 0; i < n; i++) {
        double one = 0, expected = 0;
        const char *unit = NULL;
        evl_error error;
        case_node *node = NULL;
        assert_int_equal(quantity_read(arena_printf(&arena, "1 %s", spellings[i]), row->unit, &one, &unit),
                         QUANTITY_CONVERTED);
        const char *text = arena_printf(&arena, "%.6e %s", number_within(row) / one, spellings[i]);
        assert_int_equal(quantity_read(text, row->unit, &expected, &unit), QUANTITY_CONVERTED);
        assert_true(check_text(row, text, &arena, &node, &error));
        assert_true(node_is_number(first_number(node)));
        assert_true(node_number(first_number(node)) == expected);
        assert_string_equal(first_number(node)->written, text);
    }
}

static void every_row_takes_every_spelling_of_every_unit_of_its_kind(void **state)
{
    (void)state;
    with_each_row(take_each_unit);
}

static void refuse_each_other_unit(const evl_row *row)
{
    const char *other = NULL;
    for (int i = 0; (other = unit_of_keys(i)) != NULL; i++) {
        ARENA_SCOPE memory_arena arena = {NULL};
        int n = 0, n_known = 0;
        const char **names = unit_names(other, &arena, &n), **known = unit_names(row->unit, &arena, &n_known);
        for (int k = 0; k < n; k++) {
            double one = 0;
            const char *unit = NULL, *text = arena_printf(&arena, "1 %s", names[k]);
            evl_error error;
            case_node *node = NULL;
            if (quantity_read(text, row->unit, &one, &unit) == QUANTITY_CONVERTED) {
                continue;
            }
            assert_false(check_text(row, text, &arena, &node, &error));
            assert_int_equal(error.code, EVL_EXIT_CASE);
            assert_non_null(strstr(error.message, row->key));
            assert_non_null(strstr(error.message, text));
            assert_non_null(strstr(error.message, unit_kind_name(other)));
            for (int j = 0; j < n_known; j++) {
                assert_non_null(strstr(error.message, known[j]));
            }
        }
    }
}

static void every_row_refuses_every_other_unit_with_its_kind_and_the_known_ones(void **state)
{
    (void)state;
    with_each_row(refuse_each_other_unit);
}

static void ranges_are_those_of_the_keys_unit(void **state)
{
    (void)state;
    ARENA_SCOPE memory_arena arena = {NULL};
    const case_schema *schema = model_schema();
    evl_error error;
    case_node *node = NULL;
    const evl_row *row = schema_find(schema, "wheel", "", "pressure_angle");
    assert_true(check_text(row, "0.34906585 rad", &arena, &node, &error));
    assert_false(check_text(row, "0.8 rad", &arena, &node, &error));
    assert_string_equal(error.message, "pressure_angle: is 0.8 rad (45.83662361046586 deg), must be from 5 to 45 deg");
    row = schema_find(schema, "wheel", "", "module");
    assert_false(check_text(row, "-3 mm", &arena, &node, &error));
    assert_string_equal(error.message, "module: is -3 mm (-0.003 m), must be greater than 0 m");
    row = schema_find(schema, "load", "speed", "time");
    assert_true(check_text(row, "20 ms", &arena, &node, &error));
}

static void whole_numbers_take_no_unit(void **state)
{
    (void)state;
    const case_schema *schema = model_schema();
    for (int i = 0; i < schema->n; i++) {
        ARENA_SCOPE memory_arena arena = {NULL};
        evl_error error;
        case_node *node = NULL;
        if (schema->rows[i].type == EVL_INTEGER) {
            assert_string_equal(schema->rows[i].unit, "");
            assert_false(check_text(&schema->rows[i], "500 %", &arena, &node, &error));
            assert_non_null(strstr(error.message, "must be a whole number, not '500 %'"));
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_row_takes_every_spelling_of_every_unit_of_its_kind),
        cmocka_unit_test(every_row_refuses_every_other_unit_with_its_kind_and_the_known_ones),
        cmocka_unit_test(ranges_are_those_of_the_keys_unit),
        cmocka_unit_test(whole_numbers_take_no_unit),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
