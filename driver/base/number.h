/** Numbers in the syntax of the case file: YAML 1.2 core schema, decimal. Leaf module. */
#pragma once

typedef enum {
    NUMBER_FINITE,
    NUMBER_NOT_FINITE, /**< .nan, .inf, or too large for a double */
    NUMBER_NONE        /**< not a number */
} number_kind;

/** Read a whole scalar such as -12, 2.5, .5, 1e9 or 1.0e+9; `value` is set if the result is NUMBER_FINITE. */
number_kind number_read(const char *text, double *value);

enum { NUMBER_TEXT_LENGTH = 40 };
/** Write the shortest decimal text that reads back as `value` (of a subnormal one: some text that does). An exponent
 *  comes with a decimal point and a sign, so that YAML 1.1 readers take the text for a number as well. */
void number_write(char text[NUMBER_TEXT_LENGTH], double value);
/** Write as %g does: with 15 digits if these read back as `value`, else with 17. */
void number_write_plain(char text[NUMBER_TEXT_LENGTH], double value);
