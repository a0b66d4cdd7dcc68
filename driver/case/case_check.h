/** The checker's parts: case_check.c walks the blocks, case_value.c looks at single values, case_number.c at
 *  numbers. */
#pragma once

#include "case/case_schema.h"

enum { LABEL_LENGTH = 320, NAME_BYTES = 64 };

/** Where a check is: from the root down, a checker for each step. */

typedef struct checker {
    const case_schema *schema;
    const char *path;
    evl_error *error;
    const struct checker *above; /**< of the block around; NULL at the root */
    const char *step;            /**< from there: a key or a name; NULL at the root and where it is an index */
    int index;                   /**< of an element of a list without a name; else -1 */
} checker;

/** One step down the tree, for as long as both arguments live. */
checker checker_at(const checker *above, const char *step);
/** The same, to an element of a list. @param name  NULL if it has none */
checker checker_at_element(const checker *above, const char *name, int index);
/** Write where it is, such as "wheels.gear.support", behind a text of length 0. @return its length */
size_t checker_label(const checker *checker, char label[LABEL_LENGTH]);

/* All of these return false with the error filled in if they refuse. */

__attribute__((format(printf, 3, 4))) bool checker_refuse(const checker *checker, case_place place, const char *format,
                                                          ...);
bool refuse_type(const checker *checker, const case_node *node, const char *wanted, const char *unit);

/** A name that paths and references can use. */
bool check_name(const checker *checker, case_place place, const char *name);
bool check_choice(const checker *checker, const evl_row *key, const case_node *node);
/** A number of a key whose value is one number or several. One with a unit becomes that in the key's unit. */
bool check_number(const checker *checker, const evl_row *key, case_node *node);
/** A scalar that is a number, good or bad, with or without unit. */
bool looks_like_number(const evl_row *key, const case_node *node);
/** A value of any type but block, list of blocks and map. */
bool check_single_value(const checker *checker, const evl_row *key, case_node *node);
