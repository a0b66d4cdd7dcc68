/** The checker's parts: case_check.c walks the blocks, case_value.c looks at single values. */
#pragma once

#include "case/case_schema.h"

enum { LABEL_LENGTH = 320, NAME_BYTES = 64 };

typedef struct {
    const case_schema *schema;
    const char *path;
    evl_error *error;
    char label[LABEL_LENGTH]; /**< where in the tree: "wheels.gear.support" */
} checker;

/** Go down one step. @return what checker_leave() takes to come back */
size_t checker_enter(checker *checker, const char *step);
void checker_leave(checker *checker, size_t length);

/* All of these return false with the error filled in if they refuse. */

#if defined(__GNUC__)
__attribute__((format(printf, 3, 4)))
#endif
bool checker_refuse(const checker *checker, case_place place, const char *format, ...);
bool refuse_type(const checker *checker, const case_node *node, const char *wanted, const char *unit);

/** A name that paths and references can use. */
bool check_name(const checker *checker, case_place place, const char *name);
bool check_choice(const checker *checker, const evl_row *key, const case_node *node);
/** A number of a key whose value is one number or several. */
bool check_number_of(const checker *checker, const evl_row *key, const case_node *node);
/** A value of any type but block, list of blocks and map. */
bool check_single_value(checker *checker, const evl_row *key, case_node *node);
