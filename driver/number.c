#include "number.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

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

void number_write(char text[NUMBER_TEXT_LENGTH], double value)
{
    char general[NUMBER_TEXT_LENGTH], scientific[NUMBER_TEXT_LENGTH];
    for (int digits = 15; digits <= 17; digits++) {
        (void)snprintf(general, sizeof general, "%.*g", digits, value);
        if (strtod(general, NULL) == value) {
            break;
        }
    }
    /* the point must not be missing before an exponent: %e from one digit behind it on */
    for (int digits = 1; digits <= 16; digits++) {
        (void)snprintf(scientific, sizeof scientific, "%.*e", digits, value);
        if (strtod(scientific, NULL) == value) {
            break;
        }
    }
    const bool is_plain = strchr(general, 'e') == NULL && strlen(general) <= strlen(scientific);
    (void)snprintf(text, NUMBER_TEXT_LENGTH, "%s", is_plain || !isfinite(value) ? general : scientific);
}
