/** What a case_file is made of: shared by case.c and case_edit.c. */
#pragma once

#include "case/case.h"
#include "case/case_schema.h"
#include "case/case_tree.h"

/** Of case_base_parse. */
struct case_base {
    memory_pool pool; /**< of all */
    char *name;
    const case_schema *schema;
    case_node *root;
};

/** Where an option of an edited base has put a number. */
typedef struct {
    case_node *node;    /**< NULL: the option has put something else, or was overruled by a later one */
    const evl_row *row; /**< what the number has to be */
    int place;          /**< among the numbers of the description, if nothing else depends on it; else -1 */
} case_number;

struct case_file {
    memory_pool pool; /**< of all but the text and the description */
    char *path;
    int n_options;
    char **options; /**< the nodes of the tree point to them; each has room for another number behind its path */
    case_node *root;
    char **text;          /**< made when it is asked for: a million knots take seconds; NULL for an edited base */
    case_number *numbers; /**< [n_options] of an edited base, else NULL */
    simulation_description as_read; /**< of an edited base: nothing of it is settled */
    description description;
};

/** A case with these options and without a tree. */
case_file *case_file_create(const char *path, int n_set, const char *const *set_options);
/** Whether the tree is of this format: before anything else, since a case of another format has other keys.
 *  @return false with the reason in `error` */
bool case_file_check_format(const case_file *file, evl_error *error);
/** Apply the options to the tree that the file has, check and resolve it. @return false with the reason in `error` */
bool case_file_resolve(case_file *file, const case_schema *schema, evl_error *error);

/** What a path of --set leads to.
 *  @param[out] node  of the tree; NULL if it does not go so far
 *  @return the row of the last key on the path; NULL if there is none, or several with different units of which the tree's variants
 *          choose none */
const evl_row *row_at_path(const case_schema *schema, case_node *root, const char *path, case_node **node);

/** Fill `description`, but for its entries, from a tree that schema_check accepted; gaps that are not given are added to the tree as 0.
 *  @param path  the case file, for the places in messages
 *  @return false with the reason in `error`; `description` can be freed in any case */
bool case_resolve(const case_schema *schema, const char *path, case_node *root, description *description,
                  evl_error *error);
/** Fill the entries of a description. Their names are the texts of the tree, which have to stay where they are. */
void case_lay_out(const case_schema *schema, const case_node *root, description *description);
/** Where that puts a number of the tree; -1: nowhere. */
int case_number_place(const case_schema *schema, const case_node *root, const case_node *number);
