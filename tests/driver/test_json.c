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

#include "base/json.h"

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

static void write_line(json_writer *writer)
{
    static const double values[] = {0.1, NAN, 1.0 / 3.0, 5e-324, 1e22};
    writer->is_line = true;
    json_open(writer, NULL, '{');
    json_integer(writer, "case", -12);
    json_open(writer, "list", '[');
    json_text(writer, NULL, "a\n");
    json_close(writer, ']');
    json_numbers(writer, "values", 5, values);
    json_close(writer, '}');
}

static void a_line_has_no_break_and_its_numbers_read_back_to_the_bit(void **state)
{
    (void)state;
    assert_written(write_line, "{\"case\":-12,\"list\":[\"a\\u000a\"],"
                               "\"values\":[0.1,null,0.33333333333333331,4.94065645841247e-324,1e+22]}\n");
}

static void write_no_utf8(json_writer *writer)
{
    json_open(writer, NULL, '[');
    json_text(writer, NULL, "a\xff\xc3"); /* a byte that never occurs, a character that was cut */
    json_text(writer, NULL,
              "\xc0\xaf|\xe0\x80\x80|\xed\xa0\x80|\xf4\x90\x80\x80"); /* longer than need be, surrogate, too large */
    json_text(writer, NULL, "\xe2\x82\xac\xf0\x9f\x99\x82");          /* good ones */
    json_close(writer, ']');
}

static void what_is_no_utf8_is_replaced(void **state)
{
    (void)state;
#define BAD "\xef\xbf\xbd"
    assert_written(write_no_utf8, "[\n  \"a" BAD BAD "\",\n"
                                  "  \"" BAD BAD "|" BAD BAD BAD "|" BAD BAD BAD "|" BAD BAD BAD BAD "\",\n"
                                  "  \"\xe2\x82\xac\xf0\x9f\x99\x82\"\n]\n");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(values_are_separated_by_commas_at_every_level),
        cmocka_unit_test(quotes_backslashes_and_control_characters_are_escaped),
        cmocka_unit_test(what_json_has_no_number_for_is_null),
        cmocka_unit_test(a_line_has_no_break_and_its_numbers_read_back_to_the_bit),
        cmocka_unit_test(what_is_no_utf8_is_replaced),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
