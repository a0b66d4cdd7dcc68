/** Parts of the checker: case_check.c iterates over blocks, case_value.c checks single values, case_number.c numbers. */
#pragma once

#include "case/case_schema.h"

enum { LABEL_LENGTH = 320, NAME_BYTES = 64 };

/** Position in the tree during a check: a chain of checkers from the root, one for each level. */

typedef struct checker {
    const case_schema *schema;
    const char *path;
    evl_error *error;
    const struct checker *above; /**< checker of the enclosing block; NULL at the root */
    const char *step;            /**< key or name relative to `above`; NULL at the root and for an index */
    int index;                   /**< of an element of a list without a name; else -1 */
} checker;

/** A checker one level down, valid as long as both arguments. */
checker checker_at(const checker *above, const char *step);
/** Same for an element of a list. @param name  NULL if it has none */
checker checker_at_element(const checker *above, const char *name, int index);
/** Append the path, such as "wheels.gear.support", to an empty text. @return its length */
size_t checker_label(const checker *checker, char label[LABEL_LENGTH]);

/* On refusal all functions below return false with the error filled in. */

__attribute__((format(printf, 3, 4))) bool checker_refuse(const checker *checker, case_location location,
                                                          const char *format, ...);
bool refuse_type(const checker *checker, const case_node *node, const char *expected, const char *unit);

/** Check that paths and references can use a name. */
bool check_name(const checker *checker, case_location location, const char *name);
bool check_choice(const checker *checker, const evl_row *key, const case_node *node);
/** Check a number of a key whose value is one number or several; one with a unit is converted to the key's unit. */
bool check_number(const checker *checker, const evl_row *key, case_node *node);
/** Whether a scalar is a number, valid or not, with or without unit. */
bool looks_like_number(const evl_row *key, const case_node *node);
/** Check a value of any type except block, list of blocks and map. */
bool check_single_value(const checker *checker, const evl_row *key, case_node *node);
