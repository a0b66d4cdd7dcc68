#include "base/number.h"

#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

/* ---- reading ---- */

/** Also without YAML's leading point, as other programs print these values. */
static bool is_nan_or_infinity(const char *text)
{
    text += *text == '-' || *text == '+' ? 1 : 0;
    text += *text == '.' ? 1 : 0;
    return strcasecmp(text, "nan") == 0 || strcasecmp(text, "inf") == 0 || strcasecmp(text, "infinity") == 0;
}

/* [-+]? ( \. [0-9]+ | [0-9]+ ( \. [0-9]* )? ) ( [eE] [-+]? [0-9]+ )?   (YAML 1.2, 10.3.2): what strtod accepts of these
 * characters; it accepts others too. */
number_kind number_read(const char *text, double *value)
{
    char *end = NULL;
    const bool is_decimal = text[strspn(text, "+-.0123456789eE")] == '\0';
    const double number = is_decimal ? strtod(text, &end) : NAN;
    if (!is_decimal || end == text || *end != '\0') {
        return is_nan_or_infinity(text) ? NUMBER_NOT_FINITE : NUMBER_NONE;
    }
    if (!isfinite(number)) {
        return NUMBER_NOT_FINITE;
    }
    *value = number;
    return NUMBER_FINITE;
}

/* ---- writing ---- */

/** Digits to which every decimal is preserved by a double, and digits that distinguish neighbouring doubles. */
enum { SAFE_DIGITS = 15, MOST_DIGITS = 17 };

/** Print with 15 digits if these read back as `value`, else with `step` more until they do, at most 17. @return number
 *  of digits */
static int write_general(char text[NUMBER_TEXT_LENGTH], double value, int step)
{
    int digits = SAFE_DIGITS;
    for (;; digits += step) {
        (void)snprintf(text, NUMBER_TEXT_LENGTH, "%.*g", digits, value);
        if (digits >= MOST_DIGITS || strtod(text, NULL) == value) {
            return digits;
        }
    }
}

/** Print with an exponent, without trailing zeros of the digits except the first behind the decimal point. */
static void write_scientific(char text[NUMBER_TEXT_LENGTH], double value, int digits)
{
    (void)snprintf(text, NUMBER_TEXT_LENGTH, "%.*e", digits - 1, value);
    char *exponent = strchr(text, 'e'), *end = exponent;
    while (end[-1] == '0' && end[-2] != '.') {
        end--;
    }
    memmove(end, exponent, strlen(exponent) + 1);
}

void number_write(char text[NUMBER_TEXT_LENGTH], double value)
{
    const int digits = write_general(text, value, 1);
    char scientific[NUMBER_TEXT_LENGTH];
    if (isfinite(value)) {
        write_scientific(scientific, value, digits);
        if (strchr(text, 'e') != NULL || strlen(text) > strlen(scientific)) {
            memcpy(text, scientific, sizeof scientific);
        }
    }
}

void number_write_plain(char text[NUMBER_TEXT_LENGTH], double value)
{
    static const double all_digits = 1e15; /* integers below it are printed as digits */
    if (fabs(value) < all_digits && value == (double)(long)value && !(signbit(value) && value == 0.0)) {
        (void)snprintf(text, NUMBER_TEXT_LENGTH, "%ld", (long)value);
    } else {
        (void)write_general(text, value, MOST_DIGITS - SAFE_DIGITS);
    }
}
