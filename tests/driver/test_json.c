/* JSON as scripts read it: commas, escapes, numbers to the bit. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "json.h"

static void assert_written(void (*write)(json_writer *writer), const char *expected)
{
    char *text = NULL;
    size_t length = 0;
    json_writer writer = {.stream = open_memstream(&text, &length)};
    assert_non_null(writer.stream);
    write(&writer);
    assert_int_equal(fclose(writer.stream), 0);
    assert_string_equal(text, expected);
    free(text);
}

static void write_nested(json_writer *writer)
{
    static const double point[] = {0.5, -2e-9};
    json_open(writer, NULL, '{');
    json_number(writer, "teeth", 20);
    json_open(writer, "empty", '{');
    json_close(writer, '}');
    json_open(writer, "list", '[');
    json_text(writer, NULL, "a");
    json_open(writer, NULL, '{');
    json_numbers(writer, "point", 2, point);
    json_close(writer, '}');
    json_close(writer, ']');
    json_number(writer, "last", 0.1);
    json_close(writer, '}');
}

static void values_are_separated_by_commas_at_every_level(void **state)
{
    (void)state;
    assert_written(write_nested, "{\n"
                                 "  \"teeth\": 20,\n"
                                 "  \"empty\": {},\n"
                                 "  \"list\": [\n"
                                 "    \"a\",\n"
                                 "    {\n"
                                 "      \"point\": [0.5, -2.0e-09]\n"
                                 "    }\n"
                                 "  ],\n"
                                 "  \"last\": 0.1\n"
                                 "}\n");
}

static void write_text(json_writer *writer)
{
    json_open(writer, NULL, '[');
    json_text(writer, NULL, "\" \\ / \n \t \x01 \x1f \x7f \xc3\xa9");
    json_close(writer, ']');
}

static void quotes_backslashes_and_control_characters_are_escaped(void **state)
{
    (void)state;
    assert_written(write_text, "[\n  \"\\\" \\\\ / \\u000a \\u0009 \\u0001 \\u001f \x7f \xc3\xa9\"\n]\n");
}

static void write_not_finite(json_writer *writer)
{
    static const double values[] = {NAN, 1, -INFINITY};
    json_open(writer, NULL, '{');
    json_number(writer, "value", INFINITY);
    json_numbers(writer, "values", 3, values);
    json_close(writer, '}');
}

static void what_json_has_no_number_for_is_null(void **state)
{
    (void)state;
    assert_written(write_not_finite, "{\n  \"value\": null,\n  \"values\": [null, 1, null]\n}\n");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(values_are_separated_by_commas_at_every_level),
        cmocka_unit_test(quotes_backslashes_and_control_characters_are_escaped),
        cmocka_unit_test(what_json_has_no_number_for_is_null),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
