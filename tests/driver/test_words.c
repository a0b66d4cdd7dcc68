/* Numbers and words: reading and writing a number, the nearest word, one-line errors. */
#include <float.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "base/number.h"
#include "base/status.h"
#include "base/suggest.h"
#include "base/words.h"

static void numbers_are_those_of_yaml_1_2(void **state)
{
    (void)state;
    static const struct {
        const char *text;
        double value;
    } good[] = {{"0", 0},     {"-12", -12}, {"+3", 3},       {"2.5", 2.5},         {".5", 0.5}, {"5.", 5},
                {"1e9", 1e9}, {"1E9", 1e9}, {"1.0e+9", 1e9}, {"-1.5e-3", -1.5e-3}, {"012", 12}, {"1e-400", 0}};
    static const char *const bad[] = {"",    "-",   ".",  "e5", "1e",    "1e+", "0x10", "0o17", "1_000",
                                      "1,5", "1 2", " 1", "1 ", "1.2.3", "--1", "abc",  "1d3",  "infinit"};
    static const char *const not_finite[] = {".nan",  ".NaN", "nan",      ".inf", "-.inf",
                                             "+.INF", "inf",  "Infinity", "1e309"};
    double value = 0;
    for (size_t i = 0; i < sizeof good / sizeof *good; i++) {
        assert_int_equal(number_read(good[i].text, &value), NUMBER_FINITE);
        assert_true(value == good[i].value);
    }
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        assert_int_equal(number_read(bad[i], &value), NUMBER_NONE);
    }
    for (size_t i = 0; i < sizeof not_finite / sizeof *not_finite; i++) {
        assert_int_equal(number_read(not_finite[i], &value), NUMBER_NOT_FINITE);
    }
}

static void a_written_number_reads_back_to_the_bit(void **state)
{
    (void)state;
    uint64_t bits = 88172645463325252u; /* xorshift64 */
    for (int i = 0; i < 20000; i++) {
        bits ^= bits << 13;
        bits ^= bits >> 7;
        bits ^= bits << 17;
        double value = 0, back = 0;
        memcpy(&value, &bits, sizeof value);
        if (!isfinite(value)) {
            continue;
        }
        char text[NUMBER_TEXT_LENGTH];
        number_write(text, value);
        assert_int_equal(number_read(text, &back), NUMBER_FINITE);
        assert_memory_equal(&back, &value, sizeof value);
    }
}

static void a_number_is_written_as_short_as_it_reads_well(void **state)
{
    (void)state;
    static const struct {
        double value;
        const char *text;
    } cases[] = {{0, "0"},          {0.1, "0.1"},       {7800, "7800"},     {2e11, "2.0e+11"},
                 {1e-9, "1.0e-09"}, {-0.001, "-0.001"}, {100000, "100000"}, {0.1 + 0.2, "0.30000000000000004"}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char text[NUMBER_TEXT_LENGTH];
        number_write(text, cases[i].value);
        assert_string_equal(text, cases[i].text);
    }
}

static void a_plain_number_is_what_the_c_library_writes_with_15_digits_or_17(void **state)
{
    (void)state;
    static const double some[] = {0,
                                  -0.0,
                                  1,
                                  -20,
                                  1e15,
                                  123456789012345680.0,
                                  0.1,
                                  1e-4,
                                  1e-5,
                                  5e-324,
                                  0.1 + 0.2,
                                  99999999999999.9,
                                  999999999999999.9,
                                  9.9999999999999995e22,
                                  2.5e-9,
                                  DBL_MAX};
    uint64_t bits = 88172645463325252u; /* xorshift64 */
    for (size_t i = 0; i < 20000; i++) {
        bits ^= bits << 13;
        bits ^= bits >> 7;
        bits ^= bits << 17;
        double value = 0;
        memcpy(&value, &bits, sizeof value);
        if (i % 2 == 1) { /* of few digits */
            value = (double)(bits % 1000000) * pow(10, (double)(bits >> 40 & 31) - 16);
        }
        value = i < sizeof some / sizeof *some ? some[i] : value;
        if (!isfinite(value)) {
            continue;
        }
        char text[NUMBER_TEXT_LENGTH], expected[NUMBER_TEXT_LENGTH];
        number_write_plain(text, value);
        (void)snprintf(expected, sizeof expected, "%.15g", value);
        if (strtod(expected, NULL) != value) {
            (void)snprintf(expected, sizeof expected, "%.17g", value);
        }
        assert_string_equal(text, expected);
    }
}

static void the_nearest_word_is_suggested_and_a_far_one_is_not(void **state)
{
    (void)state;
    static const char *const words[] = {"teeth", "width", "material", "stiffness", "centre", "coulomb"};
    static const struct {
        const char *text, *nearest;
    } cases[] = {{"teth", "teeth"},         {"Teeth", "teeth"},   {"wdith", "width"},    {"materail", "material"},
                 {"stifness", "stiffness"}, {"center", "centre"}, {"coulumb", "coulomb"}};
    static const char *const far[] = {"", "x", "colour", "damping", "th"};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const char *nearest = suggest_nearest(cases[i].text, 6, words);
        assert_non_null(nearest);
        assert_string_equal(nearest, cases[i].nearest);
    }
    for (size_t i = 0; i < sizeof far / sizeof *far; i++) {
        assert_null(suggest_nearest(far[i], 6, words));
    }
    assert_null(suggest_nearest("teeth", 0, NULL));
}

static void an_error_is_one_line(void **state)
{
    (void)state;
    evl_error error;
    evl_error_set(&error, EVL_EXIT_CASE, "a\nb", "x\ty\r\nz %d", 3);
    assert_string_equal(error.location, "a b");
    assert_string_equal(error.message, "x y  z 3");
    assert_int_equal(error.code, 3);
}

static void every_exit_code_has_a_meaning(void **state)
{
    (void)state;
    static const int codes[] = {0, 1, 2, 3, 4, 71, 74, 75};
    char *table = NULL, *line = NULL, *rest = NULL;
    size_t length = 0, n = 0;
    FILE *stream = open_memstream(&table, &length);
    evl_exit_print_table(stream);
    (void)fclose(stream);
    for (line = strtok_r(table, "\n", &rest); line != NULL; line = strtok_r(NULL, "\n", &rest)) {
        assert_true(n < sizeof codes / sizeof *codes);
        assert_int_equal(strtol(line, &line, 10), codes[n++]);
        assert_true(strlen(line) > strlen("  "));
    }
    assert_int_equal(n, sizeof codes / sizeof *codes);
    free(table);
}

static void a_word_is_quoted_if_a_shell_would_see_more_than_one_plain_word(void **state)
{
    (void)state;
    static const char *const words[][2] = {{"plain-1.yaml", "plain-1.yaml"},
                                           {"a=b,c/d:e@%+", "a=b,c/d:e@%+"},
                                           {"", "''"},
                                           {"two words", "'two words'"},
                                           {"$(x) `y` \\ \"", "'$(x) `y` \\ \"'"},
                                           {"it's", "'it'\\''s'"},
                                           {"''", "''\\'''\\'''"},
                                           {"~", "'~'"},
                                           {"a\nb", "'a\nb'"}};
    for (size_t i = 0; i < sizeof words / sizeof *words; i++) {
        char *quoted = words_quoted(words[i][0]);
        assert_string_equal(quoted, words[i][1]);
        free(quoted);
    }
}

static void a_word_is_found_whole_and_not_by_how_it_begins(void **state)
{
    (void)state;
    assert_true(words_contain("wheel axis  wheels", "axis"));
    assert_true(words_contain("wheel axis  wheels", "wheels"));
    assert_true(words_contain("wheel axis  wheels", "wheel"));
    static const char *const none[] = {"whee", "axis wheels", "wheelss", "", " ", "heel"};
    for (size_t i = 0; i < sizeof none / sizeof *none; i++) {
        assert_false(words_contain("wheel axis  wheels", none[i]));
    }
    assert_false(words_contain("wheels", "wheel"));
    assert_false(words_contain("", "wheel"));
}

static void a_text_is_cut_between_its_characters(void **state)
{
    (void)state;
    const char *const text = "a\xc2\xb5\xe2\x82\xac\xf0\x9f\x98\x80z"; /* of 1, 2, 3, 4 and 1 byte */
    static const int shown[] = {0, 1, 1, 3, 3, 3, 6, 6, 6, 6, 10, 11, 11};
    for (int most = 0; most < 13; most++) {
        assert_int_equal(words_cut(text, most), shown[most]);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(numbers_are_those_of_yaml_1_2),
        cmocka_unit_test(a_written_number_reads_back_to_the_bit),
        cmocka_unit_test(a_number_is_written_as_short_as_it_reads_well),
        cmocka_unit_test(a_plain_number_is_what_the_c_library_writes_with_15_digits_or_17),
        cmocka_unit_test(the_nearest_word_is_suggested_and_a_far_one_is_not),
        cmocka_unit_test(an_error_is_one_line),
        cmocka_unit_test(every_exit_code_has_a_meaning),
        cmocka_unit_test(a_word_is_quoted_if_a_shell_would_see_more_than_one_plain_word),
        cmocka_unit_test(a_word_is_found_whole_and_not_by_how_it_begins),
        cmocka_unit_test(a_text_is_cut_between_its_characters),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
