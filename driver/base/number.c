#include "base/number.h"

#include <ctype.h>
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- reading ---- */

static const char *skip_digits(const char *text)
{
    while (isdigit((unsigned char)*text)) {
        text++;
    }
    return text;
}

/** [-+]? ( \. [0-9]+ | [0-9]+ ( \. [0-9]* )? ) ( [eE] [-+]? [0-9]+ )?   (YAML 1.2, 10.3.2) */
static bool is_decimal(const char *text)
{
    if (*text == '-' || *text == '+') {
        text++;
    }
    const char *end = skip_digits(text);
    const bool has_whole = end > text;
    bool has_fraction = false;
    if (*end == '.') {
        text = end + 1;
        end = skip_digits(text);
        has_fraction = end > text;
    }
    if (!has_whole && !has_fraction) {
        return false;
    }
    if (*end == 'e' || *end == 'E') {
        end++;
        if (*end == '-' || *end == '+') {
            end++;
        }
        text = end;
        end = skip_digits(text);
        if (end == text) {
            return false;
        }
    }
    return *end == '\0';
}

/** Also without YAML's leading point, as other programs print it. */
static bool is_nan_or_infinity(const char *text)
{
    static const char *const words[] = {"nan", "inf", "infinity"};
    if (*text == '-' || *text == '+') {
        text++;
    }
    if (*text == '.') {
        text++;
    }
    for (size_t i = 0; i < sizeof words / sizeof *words; i++) {
        const char *word = words[i];
        size_t k = 0;
        while (word[k] != '\0' && tolower((unsigned char)text[k]) == word[k]) {
            k++;
        }
        if (word[k] == '\0' && text[k] == '\0') {
            return true;
        }
    }
    return false;
}

number_kind number_read(const char *text, double *value)
{
    if (!is_decimal(text)) {
        return is_nan_or_infinity(text) ? NUMBER_NOT_FINITE : NUMBER_NONE;
    }
    const double number = strtod(text, NULL);
    if (!isfinite(number)) {
        return NUMBER_NOT_FINITE;
    }
    *value = number;
    return NUMBER_FINITE;
}

/* ---- writing ---- */

/** Digits of a double that all decimals survive, and those that tell every double from its neighbours. */
enum { SAFE_DIGITS = 15, MOST_DIGITS = 17 };

/** A finite number: d.ddd x 10^exponent. */
typedef struct {
    bool is_negative;
    int precision; /**< digits that it was rounded to */
    int n;         /**< of them without the zeros at the end; at least 1 */
    int exponent;
    char digits[MOST_DIGITS + 1];
} decimal;

static void count_digits(decimal *d)
{
    d->n = d->precision;
    while (d->n > 1 && d->digits[d->n - 1] == '0') {
        d->n--;
    }
}

/** Correctly rounded. */
static decimal take_apart(double value, int precision)
{
    char text[NUMBER_TEXT_LENGTH];
    decimal d = {.is_negative = signbit(value) != 0, .precision = precision};
    (void)snprintf(text, sizeof text, "%.*e", precision - 1, fabs(value));
    d.digits[0] = text[0];
    memcpy(d.digits + 1, text + 2, (size_t)precision - 1);
    d.exponent = (int)strtol(text + precision + 2, NULL, 10);
    count_digits(&d);
    return d;
}

/** To fewer digits, halves up. */
static decimal shorten(const decimal *from, int precision)
{
    decimal d = *from;
    int i = precision - 1;
    d.precision = precision;
    if (from->digits[precision] >= '5') {
        while (i >= 0 && d.digits[i] == '9') {
            d.digits[i--] = '0';
        }
        if (i >= 0) {
            d.digits[i]++;
        } else {
            d.digits[0] = '1';
            d.exponent++;
        }
    }
    count_digits(&d);
    return d;
}

/** "e-09" at `text`. */
static void write_exponent(char *text, int exponent)
{
    const int size = abs(exponent);
    *text++ = 'e';
    *text++ = exponent < 0 ? '-' : '+';
    if (size >= 100) {
        *text++ = (char)('0' + size / 100);
    }
    *text++ = (char)('0' + size / 10 % 10);
    *text++ = (char)('0' + size % 10);
    *text = '\0';
}

/** @param n  digits, at least 1; those that the number does not have are zeros */
static void write_scientific(char text[NUMBER_TEXT_LENGTH], const decimal *d, int n)
{
    if (d->is_negative) {
        *text++ = '-';
    }
    *text++ = d->digits[0];
    if (n > 1) {
        *text++ = '.';
    }
    for (int i = 1; i < n; i++) {
        *text++ = (char)(i < d->n ? d->digits[i] : '0');
    }
    write_exponent(text, d->exponent);
}

/** Without an exponent. */
static void write_fixed(char text[NUMBER_TEXT_LENGTH], const decimal *d)
{
    if (d->is_negative) {
        *text++ = '-';
    }
    if (d->exponent < 0) {
        *text++ = '0';
        *text++ = '.';
        for (int i = -1; i > d->exponent; i--) {
            *text++ = '0';
        }
    }
    for (int i = 0; i < d->n || i <= d->exponent; i++) {
        if (i > 0 && i == d->exponent + 1) {
            *text++ = '.';
        }
        *text++ = (char)(i < d->n ? d->digits[i] : '0');
    }
    *text = '\0';
}

/** As %g does. */
static bool needs_exponent(const decimal *d)
{
    return d->exponent < -4 || d->exponent >= d->precision;
}

static bool reads_back(const decimal *d, double value)
{
    char text[NUMBER_TEXT_LENGTH];
    write_scientific(text, d, d->n);
    return strtod(text, NULL) == value;
}

/** Whether a decimal of few digits can be the nearest to `value`, whose 17 digits these are: half the distance of two
 *  doubles is less than 12 units of the last digit. */
static bool is_near_short_one(const decimal *d, double value)
{
    const int tail = 10 * (d->digits[MOST_DIGITS - 2] - '0') + d->digits[MOST_DIGITS - 1] - '0';
    return tail <= 12 || tail >= 88 || fabs(value) < DBL_MIN;
}

/** With 15 digits if these read back as `value`, with 17 if not; `try_between`: with 16 if they do. */
static decimal shortest(double value, bool try_between)
{
    const decimal full = take_apart(value, MOST_DIGITS);
    decimal shorter = full;
    if (is_near_short_one(&full, value)) {
        shorter = shorten(&full, SAFE_DIGITS);
        if (reads_back(&shorter, value)) {
            return shorter;
        }
    }
    if (try_between) {
        const bool is_halfway = full.digits[MOST_DIGITS - 1] == '5'; /* of a number that was rounded already */
        shorter = is_halfway ? take_apart(value, SAFE_DIGITS + 1) : shorten(&full, SAFE_DIGITS + 1);
        if (reads_back(&shorter, value)) {
            return shorter;
        }
    }
    return full;
}

void number_write(char text[NUMBER_TEXT_LENGTH], double value)
{
    if (!isfinite(value)) {
        (void)snprintf(text, NUMBER_TEXT_LENGTH, "%g", value);
        return;
    }
    const decimal d = shortest(value, true);
    char scientific[NUMBER_TEXT_LENGTH];
    /* the point must not be missing before an exponent */
    write_scientific(scientific, &d, d.n > 1 ? d.n : 2);
    if (!needs_exponent(&d)) {
        write_fixed(text, &d);
    }
    if (needs_exponent(&d) || strlen(text) > strlen(scientific)) {
        memcpy(text, scientific, sizeof scientific);
    }
}

/** A whole number of at most 15 digits. */
static void write_whole(char text[NUMBER_TEXT_LENGTH], double value)
{
    char digits[SAFE_DIGITS + 1];
    int n = 0;
    long long rest = llabs((long long)value);
    do {
        digits[n++] = (char)('0' + rest % 10);
        rest /= 10;
    } while (rest > 0);
    if (signbit(value) != 0) {
        *text++ = '-';
    }
    while (n > 0) {
        *text++ = digits[--n];
    }
    *text = '\0';
}

void number_write_plain(char text[NUMBER_TEXT_LENGTH], double value)
{
    if (!isfinite(value)) {
        (void)snprintf(text, NUMBER_TEXT_LENGTH, "%g", value);
        return;
    }
    if (fabs(value) < 1e15 && value == trunc(value)) {
        write_whole(text, value);
        return;
    }
    const decimal d = shortest(value, false);
    if (needs_exponent(&d)) {
        write_scientific(text, &d, d.n);
    } else {
        write_fixed(text, &d);
    }
}
