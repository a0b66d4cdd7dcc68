#include "base/number.h"

#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

/* ---- reading ---- */

/** Also without YAML's leading point, as other programs print it. */
static bool is_nan_or_infinity(const char *text)
{
    text += *text == '-' || *text == '+' ? 1 : 0;
    text += *text == '.' ? 1 : 0;
    return strcasecmp(text, "nan") == 0 || strcasecmp(text, "inf") == 0 || strcasecmp(text, "infinity") == 0;
}

/* [-+]? ( \. [0-9]+ | [0-9]+ ( \. [0-9]* )? ) ( [eE] [-+]? [0-9]+ )?   (YAML 1.2, 10.3.2): what strtod takes of these
 * characters; it takes others too. */
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

/** Digits of a double that all decimals survive, and those that tell every double from its neighbours. */
enum { SAFE_DIGITS = 15, MOST_DIGITS = 17 };

/** With 15 digits if these read back as `value`, else with `step` more until they do, at most 17. @return how many */
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

/** With an exponent, and without the zeros at the end of the digits but for the first behind the point. */
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
    static const double all_digits = 1e15; /* whole numbers below are those digits */
    if (fabs(value) < all_digits && value == (double)(long)value && !(signbit(value) && value == 0.0)) {
        (void)snprintf(text, NUMBER_TEXT_LENGTH, "%ld", (long)value);
    } else {
        (void)write_general(text, value, MOST_DIGITS - SAFE_DIGITS);
    }
}
