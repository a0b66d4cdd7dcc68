/** What a case_file is made of: shared by case.c and case_edit.c. */
#pragma once

#include "case/case.h"
#include "case/case_schema.h"
#include "case/case_tree.h"

/** Where an option of an edited base has put a number. */
typedef struct {
    case_node *node;    /**< NULL: the option has put something else, or was overruled by a later one */
    const evl_row *row; /**< what the number has to be */
} case_number;

struct case_file {
    char *path;
    int n_options;
    char **options; /**< the nodes of the tree point to them; each has room for another number behind its path */
    case_node *root;
    char *text;           /**< NULL for an edited base */
    case_number *numbers; /**< [n_options] of an edited base, else NULL */
    description description;
};

/** A case with these options and without a tree. */
case_file *case_file_create(const char *path, int n_set, const char *const *set_options);
/** Apply the options to the tree that the file has, check and resolve it. @return false with the reason in `error` */
bool case_file_resolve(case_file *file, const case_schema *schema, evl_error *error);
