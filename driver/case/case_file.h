/** Contents of a case_file and of a case_base: shared by the files that implement case.h. */
#pragma once

#include "case/case_schema.h"
#include "case/case_tree.h"
#include "case/description.h"

/** See case_base_parse. */
typedef struct case_base {
    memory_arena arena; /**< owns all members */
    char *name;
    const case_schema *schema;
    case_node *root;
} case_base;

/** Number set by an option of an edited base. */
typedef struct {
    case_node *node;    /**< NULL: the option sets something else, or a later one overrides it */
    const evl_row *row; /**< constraints on the number */
    int index;          /**< index among the description's numbers, if no other value depends on it; else -1 */
} case_number;

typedef struct case_file {
    memory_arena arena; /**< owns all members except the text and the description */
    char *path;
    int n_options;
    char **options; /**< referenced by the nodes of the tree; each has space for another number behind its path */
    case_node *root;
    char **text;          /**< created on request, since a million knots take seconds; NULL for an edited base */
    case_number *numbers; /**< [n_options] of an edited base, else NULL */
    simulation_description as_read; /**< of an edited base: before the defaults of the model are filled in */
    description description;
} case_file;

/** A case with these options, without a tree. */
case_file *case_file_create(const char *path, int n_set, const char *const *set_options);
/** Whether the tree has this format. To be called first, since a case of another format has other keys.
 *  @return false with the reason in `error` */
bool case_file_check_format(const case_file *file, evl_error *error);
/** Apply the options to the file's tree, check and resolve it. @return false with the reason in `error` */
bool case_file_resolve(case_file *file, const case_schema *schema, evl_error *error);

/** Find the node and the row of a --set path.
 *  @param[out] node  of the tree; NULL if the tree does not contain it
 *  @return row of the last key on the path; NULL if there is none, or if several have different units and the tree's
 *          variants select none */
const evl_row *row_at_path(const case_schema *schema, case_node *root, const char *path, case_node **node);

/** Fill `description`, except its entries, from a tree that schema_check accepted; absent gaps are added to the tree as
 *  0.
 *  @param path  the case file, for locations in messages
 *  @return false with the reason in `error`; `description` can be freed in any case */
bool case_resolve(const case_schema *schema, const char *path, case_node *root, description *description,
                  evl_error *error);
struct checker;
/** The part of case_resolve for the block `simulation`. */
bool case_resolve_simulation(const struct checker *checker, const case_node *block, description *description);
/** Fill the entries of a description. Their names are texts of the tree and must remain at the same address. */
void case_lay_out(const case_schema *schema, const case_node *root, description *description);
/** Index of a number of the tree among the description's numbers; -1 if it has none. */
int case_number_index(const case_schema *schema, const case_node *root, const case_node *number);
