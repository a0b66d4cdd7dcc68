/** Numbers as the case file writes them: YAML 1.2 core schema, decimal. A leaf. */
#pragma once

typedef enum {
    NUMBER_FINITE,
    NUMBER_NOT_FINITE, /**< .nan, .inf, or too large for a double */
    NUMBER_NONE        /**< not a number at all */
} number_kind;

/** Read a whole scalar such as -12, 2.5, .5, 1e9 or 1.0e+9; `value` is set if the result is NUMBER_FINITE. */
number_kind number_read(const char *text, double *value);

enum { NUMBER_TEXT_LENGTH = 40 };
/** The shortest decimal text that reads back as `value` (of a subnormal one: a text), with a point and a signed exponent where there is an exponent:
 *  YAML 1.1 readers take it for a number as well. */
void number_write(char text[NUMBER_TEXT_LENGTH], double value);
/** As %g writes it: with 15 digits if these read back as `value`, with 17 if not. */
void number_write_plain(char text[NUMBER_TEXT_LENGTH], double value);
