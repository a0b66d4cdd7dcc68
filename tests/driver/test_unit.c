/* The table of units: what a number in each of them is, in all spellings, and what is refused. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "base/memory.h"
#include "case/unit.h"
#include "case/unit_spelling.h"
#include "model/model.h"

/** What one of the unit is in that of the key. */
typedef struct {
    const char *key_unit, *name;
    long double factor;
} size_of_unit;

static const long double PI = 3.14159265358979323846264338327950288L;

static long double size_of_one(const char *key_unit, const char *name)
{
    const size_of_unit sizes[] = {
        {"m", "in", 0.0254L},
        {"s", "min", 60},
        {"s", "h", 3600},
        {"deg", "rad", 180 / PI},
        {"deg", "mrad", 0.18L / PI},
        {"deg", "arcmin", 1 / 60.0L},
        {"rad/s", "rpm", 2 * PI / 60},
        {"rad/s", "1/min", 2 * PI / 60},
        {"rad/s", "deg/s", PI / 180},
        {"rad/s", "°/s", PI / 180},
        {"Hz", "1/min", 1 / 60.0L},
        {"m/s", "m/min", 1 / 60.0L},
        {"m/s", "km/h", 1 / 3.6L},
        {"N m/rad", "N m/deg", 180 / PI},
        {"N m s/rad", "N m/rpm", 30 / PI},
    };
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
        if (strcmp(sizes[i].key_unit, key_unit) == 0 && strcmp(sizes[i].name, name) == 0) {
            return sizes[i].factor;
        }
    }
    return 0; /* a power of ten */
}

/** The power of ten of a unit, by the prefixes of its symbols, from left to right. */
static int exponent_of(const char *key_unit, const char *name)
{
    static const struct {
        const char *key_unit, *name;
        int exponent;
    } others[] = {{"Pa", "bar", 5},      {"kg", "t", 3},         {"kg", "g", -3},
                  {"kg/m3", "t/m3", 3},  {"kg m2", "g cm2", -7}, {"kg m2", "g mm2", -9},
                  {"kg/m3", "g/cm3", 3}, {"", "%", -2},          {"Pa", "N/(mm um)", 9}};
    for (size_t i = 0; i < sizeof others / sizeof *others; i++) {
        if (strcmp(others[i].key_unit, key_unit) == 0 && strcmp(others[i].name, name) == 0) {
            return others[i].exponent;
        }
    }
    static const struct {
        const char *symbol;
        int exponent;
    } prefixed[] = {{"GPa", 9}, {"MPa", 6}, {"kPa", 3},  {"kN", 3},  {"mN", -3}, {"MN", 6},
                    {"kHz", 3}, {"mm", -3}, {"um", -6},  {"nm", -9}, {"cm", -2}, {"dm", -1},
                    {"ms", -3}, {"us", -6}, {"mPa", -3}, {"cP", -3}, {"kW", 3},  {"kJ", 3}};
    int exponent = 0, sign = 1;
    for (const char *c = name; *c != '\0';) {
        const size_t length = strcspn(c, " /0123456789");
        sign = *c == '/' ? -1 : sign;
        for (size_t i = 0; i < sizeof prefixed / sizeof *prefixed && length > 0; i++) {
            if (strlen(prefixed[i].symbol) == length && strncmp(prefixed[i].symbol, c, length) == 0) {
                const int power = c[length] == '2' ? 2 : c[length] == '3' ? 3 : 1;
                exponent += sign * power * prefixed[i].exponent;
            }
        }
        c += length == 0 ? 1 : length;
    }
    return exponent;
}

static void with_each_unit(void (*call)(const char *key_unit, const char *name))
{
    const char *key_unit = NULL;
    for (int i = 0; (key_unit = unit_of_keys(i)) != NULL; i++) {
        int n = 0;
        CLEANUP_FREE const char **names = unit_names(key_unit, NULL, &n);
        assert_true(n > 0);
        for (int k = 0; k < n; k++) {
            call(key_unit, names[k]);
        }
    }
}

/* ---- the values ---- */

static const char *const numbers[] = {"3",
                                      "3.3",
                                      "-0.1",
                                      "+7",
                                      ".123456789012345678",
                                      "20.",
                                      "1e-3",
                                      "8.5E+4",
                                      "6.62607015e-34",
                                      "1.7",
                                      "0",
                                      "-0",
                                      "123456789012345678901234567890"};

/** Number at the zero of a unit, in that of the key. */
static long double zero_of(const char *key_unit, const char *name)
{
    const bool is_celsius = strcmp(name, "degC") == 0 || strcmp(name, "°C") == 0;
    return strcmp(key_unit, "K") == 0 && is_celsius ? 273.15L : 0;
}

static void check_numbers(const char *key_unit, const char *name)
{
    const long double zero = zero_of(key_unit, name), size = zero > 0 ? 1 : size_of_one(key_unit, name);
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++) {
        double value = 0, number = strtod(numbers[i], NULL), expected = number;
        const char *unit = NULL;
        CLEANUP_FREE char *text = xasprintf("%s %s", numbers[i], name);
        assert_int_equal(quantity_read(text, key_unit, &value, &unit), QUANTITY_CONVERTED);
        if (size == 0) { /* the double of the same digits in the key's unit */
            const char *e = strpbrk(numbers[i], "eE");
            const int exponent = (e == NULL ? 0 : (int)strtol(e + 1, NULL, 10)) + exponent_of(key_unit, name);
            CLEANUP_FREE char *shifted = xasprintf("%.*se%d", (int)strcspn(numbers[i], "eE"), numbers[i], exponent);
            expected = strtod(shifted, NULL);
            assert_memory_equal(&value, &expected, sizeof value);
        } else { /* one rounding, here and there: neighbours at most */
            expected = (double)(number * size + zero);
            assert_true(fabs(value - expected) <= fabs(nextafter(expected, INFINITY) - expected));
        }
    }
}

static void numbers_in_every_unit_are_those_of_the_keys_unit(void **state)
{
    (void)state;
    with_each_unit(check_numbers);
    double value = 0;
    const char *unit = NULL;
    assert_int_equal(quantity_read("3 mm", "m", &value, &unit), QUANTITY_CONVERTED);
    assert_true(value == 0.003);
    assert_int_equal(quantity_read("66.8um", "m", &value, &unit), QUANTITY_CONVERTED);
    assert_true(value == 66.8e-6);
    assert_int_equal(quantity_read("206   GPa", "Pa", &value, &unit), QUANTITY_CONVERTED);
    assert_true(value == 2.06e11);
    assert_int_equal(quantity_read("1500 rpm", "rad/s", &value, &unit), QUANTITY_CONVERTED);
    assert_true(value == 157.07963267948966);
    assert_int_equal(quantity_read("90 °", "deg", &value, &unit), QUANTITY_CONVERTED);
    assert_true(value == 90);
    assert_int_equal(quantity_read("0.003", "m", &value, &unit), QUANTITY_NUMBER);
    assert_true(value == 0.003);
    assert_int_equal(quantity_read("90 degC", "K", &value, &unit), QUANTITY_CONVERTED);
    assert_true(value == 363.15);
    assert_int_equal(quantity_read("-273.15°C", "K", &value, &unit), QUANTITY_CONVERTED);
    assert_true(value == 0);
}

/* ---- the spellings ---- */

static void every_spelling_is_read_and_means_one_unit(void **state)
{
    (void)state;
    const char *key_unit = NULL;
    for (int i = 0; (key_unit = unit_of_keys(i)) != NULL; i++) {
        ARENA_SCOPE memory_arena arena = {NULL};
        int n = 0;
        const char **spellings = unit_spellings(key_unit, &arena, &n);
        for (int k = 0; k < n; k++) {
            double value = 0;
            const char *unit = NULL;
            CLEANUP_FREE char *close = xasprintf("1e0%s", spellings[k]), *apart = xasprintf("1 %s", spellings[k]);
            assert_int_equal(quantity_read(apart, key_unit, &value, &unit), QUANTITY_CONVERTED);
            assert_string_equal(unit, spellings[k]);
            assert_int_equal(quantity_read(close, key_unit, &value, &unit),
                             spellings[k][0] == '1' ? QUANTITY_NONE : QUANTITY_CONVERTED);
            for (int other = 0; other < k; other++) {
                assert_string_not_equal(spellings[k], spellings[other]);
            }
        }
    }
}

static void usual_spellings_are_among_them(void **state)
{
    (void)state;
    static const char *const spelled[][3] = {
        {"m", "20 µm", "20 um"},
        {"m", "20 μm", "20 um"},
        {"rad/s", "3 rad s-1", "3 rad/s"},
        {"rad/s", "3 rad·s⁻¹", "3 rad/s"},
        {"rad/s", "1500 min-1", "1500 rpm"},
        {"rad/s", "1500 min⁻¹", "1500 rpm"},
        {"m/s2", "9.81 m/s^2", "9.81 m/s2"},
        {"m/s2", "9.81 m/s²", "9.81 m/s2"},
        {"m/s2", "9.81 m s-2", "9.81 m/s2"},
        {"N m", "150 Nm", "150 N m"},
        {"N m", "150 N·m", "150 N m"},
        {"N m", "2 kNm", "2 kN m"},
        {"N m", "150 Nmm", "150 N mm"},
        {"Pa", "210000 N/mm^2", "210000 N/mm2"},
        {"kg m2", "3 kgm²", "3 kg m2"},
        {"kg m2", "3 kg·mm²", "3 kg mm2"},
        {"N m s/rad", "1 Nms/rad", "1 N m s/rad"},
        {"N/m", "14 N um-1", "14 N/um"},
        {"1/Pa", "2 Pa-1", "2 1/Pa"},
        {"W/(m K)", "45 W m-1 K-1", "45 W/(m K)"},
        {"W/(m K)", "45 W/(m·K)", "45 W/(m K)"},
        {"J/(kg K)", "460 J kg^-1 K^-1", "460 J/(kg K)"},
    };
    for (size_t i = 0; i < sizeof spelled / sizeof *spelled; i++) {
        double value = 0, same = 0;
        const char *unit = NULL;
        assert_int_equal(quantity_read(spelled[i][1], spelled[i][0], &value, &unit), QUANTITY_CONVERTED);
        assert_int_equal(quantity_read(spelled[i][2], spelled[i][0], &same, &unit), QUANTITY_CONVERTED);
        assert_true(value == same);
    }
}

/** A slip of the shift key may not change a value by 1e9. */
static void no_kind_has_a_unit_with_milli_and_with_mega(void **state)
{
    (void)state;
    const char *key_unit = NULL;
    for (int i = 0; (key_unit = unit_of_keys(i)) != NULL; i++) {
        int n = 0;
        CLEANUP_FREE const char **names = unit_names(key_unit, NULL, &n);
        for (int k = 0; k < n; k++) {
            for (int other = 0; other < k; other++) {
                assert_string_not_equal(names[k] + 1,
                                        names[other][0] == 'M' && names[k][0] == 'm' ? names[other] + 1 : "\n");
                assert_string_not_equal(names[k] + 1,
                                        names[other][0] == 'm' && names[k][0] == 'M' ? names[other] + 1 : "\n");
            }
        }
    }
}

static void every_unit_of_the_models_keys_is_in_the_table_and_taken_by_them(void **state)
{
    (void)state;
    const case_schema *schema = model_schema();
    for (int i = 0; i < schema->n; i++) {
        const char *key_unit = schema->rows[i].unit;
        double value = 0;
        const char *unit = NULL;
        assert_non_null(unit_kind_name(key_unit));
        if (key_unit[0] != '\0') {
            CLEANUP_FREE char *text = xasprintf("2.5 %s", key_unit);
            assert_int_equal(quantity_read(text, key_unit, &value, &unit), QUANTITY_CONVERTED);
            assert_true(value == 2.5);
        }
    }
}

/* ---- for reading ---- */

static void assert_reads(double value, const char *key_unit, const char *text)
{
    CLEANUP_FREE char *found = quantity_text(value, key_unit);
    assert_string_equal(found, text);
}

static void numbers_are_printed_in_the_unit_that_suits_their_size(void **state)
{
    (void)state;
    assert_reads(0.003, "m", "3 mm");
    assert_reads(1e-4, "m", "0.1 mm");
    assert_reads(-3e-5, "m", "-30 um");
    assert_reads(12, "m", "12000 mm");
    assert_reads(0, "m", "0 mm");
    assert_reads(2.06e11, "Pa", "206 GPa");
    assert_reads(-150, "N m", "-150 N m");
    assert_reads(1.4e9, "N/m", "1400 N/um");
    assert_reads(1e4, "N/m", "10 N/mm");
    assert_reads(0.05, "s", "50 ms");
    assert_reads(0.03, "kg m2", "0.03 kg m2");
    assert_reads(1.95e-4, "kg m2", "195 kg mm2");
    assert_reads(157.07963267948966, "rad/s", "1500 rpm");
    assert_reads(152.9, "rad/s", "152.9 rad/s");
    assert_reads(0.07, "", "0.07");
    const reading_unit degrees = unit_for_reading("rad", 0.5), none = unit_for_reading("1", 0.5);
    assert_string_equal(degrees.name, "deg");
    assert_true(fabs(degrees.factor - 57.29577951308232) < 1e-13);
    assert_string_equal(none.name, "");
}

/** Whatever the digits. */
static void what_is_printed_reads_back_as_the_same_double(void **state)
{
    (void)state;
    const char *key_unit = NULL;
    for (int i = 0; (key_unit = unit_of_keys(i)) != NULL; i++) {
        double number = 1e-9 / 7;
        for (int k = 0; k < 300; k++, number *= -1.1234567) {
            double value = 0;
            const char *unit = NULL;
            CLEANUP_FREE char *text = quantity_text(number, key_unit);
            const quantity_kind kind = quantity_read(text, key_unit, &value, &unit);
            assert_int_equal(kind, key_unit[0] == '\0' ? QUANTITY_NUMBER : QUANTITY_CONVERTED);
            assert_true(value == number);
        }
    }
}

/* ---- what is refused ---- */

static void refuse_in_other_kinds(const char *key_unit, const char *name)
{
    const char *other = NULL;
    CLEANUP_FREE char *text = xasprintf("3 %s", name);
    for (int i = 0; (other = unit_of_keys(i)) != NULL; i++) {
        double value = 0;
        const char *unit = NULL;
        const quantity_kind kind = quantity_read(text, other, &value, &unit);
        if (kind == QUANTITY_CONVERTED) { /* the unit has two meanings: it has to be the table that says so */
            assert_true(strcmp(other, key_unit) == 0 || strcmp(name, "1/min") == 0);
            continue;
        }
        assert_int_equal(kind, QUANTITY_OTHER_UNIT);
        CLEANUP_FREE char *refusal = unit_refusal(other, unit);
        assert_non_null(strstr(refusal, unit_kind_name(key_unit)));
        int n = 0;
        CLEANUP_FREE const char **names = unit_names(other, NULL, &n);
        for (int k = 0; k < n; k++) {
            assert_non_null(strstr(refusal, names[k]));
        }
    }
}

static void a_unit_of_another_kind_is_refused_with_its_kind_and_with_all_that_are_taken(void **state)
{
    (void)state;
    with_each_unit(refuse_in_other_kinds);
    CLEANUP_FREE char *refusal = unit_refusal("m", "N");
    assert_string_equal(refusal, "'N' is a unit of force; write the length in mm, um, nm, cm, m, in");
    CLEANUP_FREE char *near = unit_refusal("m", "Mm");
    assert_string_equal(near,
                        "the unit 'Mm' is unknown (did you mean 'mm'?); write the length in mm, um, nm, cm, m, in");
    CLEANUP_FREE char *none = unit_refusal("", "mm");
    assert_string_equal(none, "'mm' is a unit of length, and this number has none; omit it, or write %");
}

static void what_is_no_number_with_a_unit_is_told_from_an_unknown_unit(void **state)
{
    (void)state;
    static const char *const none[] = {"",         "mm",     "- 3 mm", "1,5 mm", "3 4 mm", "1 500 mm",
                                       "0.3.1 mm", "--3 mm", " 3 mm",  "e3 mm",  "31/min"};
    static const char *const unknown[] = {"3 furlong", "3 mm ",      "3 mm x",  "3 Mm", "3 MM",
                                          "3eV",       "3 N ms/rad", "3  1/mm", "3 m2"};
    static const char *const not_finite[] = {".inf",     "nan", "1e400", "1e400 mm", "1e99999999999999999999 m",
                                             "-1e312 mm"};
    double value = 0;
    const char *unit = NULL;
    for (size_t i = 0; i < sizeof none / sizeof *none; i++) {
        assert_int_equal(quantity_read(none[i], "m", &value, &unit), QUANTITY_NONE);
    }
    for (size_t i = 0; i < sizeof unknown / sizeof *unknown; i++) {
        assert_int_equal(quantity_read(unknown[i], "m", &value, &unit), QUANTITY_OTHER_UNIT);
    }
    for (size_t i = 0; i < sizeof not_finite / sizeof *not_finite; i++) {
        assert_int_equal(quantity_read(not_finite[i], "m", &value, &unit), QUANTITY_NOT_FINITE);
    }
    assert_int_equal(quantity_read("1e310 mm", "m", &value, &unit), QUANTITY_CONVERTED);
    assert_true(value == 1e307);
}

/** And so one unit has one spelling there, whichever its key has. */
static void units_of_results_are_spellings_without_a_slash(void **state)
{
    (void)state;
    for (int i = 0; unit_of_keys(i) != NULL; i++) {
        const char *unit = unit_of_keys(i);
        CLEANUP_FREE char *reported = unit_of_results(unit);
        const bool has_stroke = strchr(reported, '/') != NULL && strchr(unit, '^') == NULL;
        if (has_stroke || !unit_is_spelled(unit, reported)) {
            fail_msg("'%s' is told as '%s'", unit, reported);
        }
    }
    CLEANUP_FREE char *speed = unit_of_results("rad/s"), *density = unit_of_results("kg/m3");
    assert_string_equal(speed, "rad s-1");
    assert_string_equal(density, "kg m-3");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(numbers_in_every_unit_are_those_of_the_keys_unit),
        cmocka_unit_test(every_spelling_is_read_and_means_one_unit),
        cmocka_unit_test(usual_spellings_are_among_them),
        cmocka_unit_test(units_of_results_are_spellings_without_a_slash),
        cmocka_unit_test(no_kind_has_a_unit_with_milli_and_with_mega),
        cmocka_unit_test(every_unit_of_the_models_keys_is_in_the_table_and_taken_by_them),
        cmocka_unit_test(numbers_are_printed_in_the_unit_that_suits_their_size),
        cmocka_unit_test(what_is_printed_reads_back_as_the_same_double),
        cmocka_unit_test(a_unit_of_another_kind_is_refused_with_its_kind_and_with_all_that_are_taken),
        cmocka_unit_test(what_is_no_number_with_a_unit_is_told_from_an_unknown_unit),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
