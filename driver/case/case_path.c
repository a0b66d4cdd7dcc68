/* Schema row at a --set path. */
#include "case/case.h"

#include "base/memory.h"
#include "case/case_file.h"
#include "case/former_keys.h"
#include "case/unit.h"

#include <string.h>

/** Block that defines the keys of a value, or of its elements; NULL if there is none. */
static const char *block_below(const evl_row *row, bool is_element)
{
    const bool has_elements = row->type == EVL_LIST || row->type == EVL_MAP;
    return has_elements == is_element && (has_elements || row->type == EVL_BLOCK) ? row->holds : NULL;
}

/** Row of a key of a block, in the variant of the tree's node (NULL: no node). If that variant does not contain the
 *  key: the first row in another variant, provided that all such rows have the same unit. */
static const evl_row *row_of_key(const case_schema *schema, const char *block, const case_node *node, const char *key)
{
    const evl_row *found = node == NULL ? NULL : schema_find(schema, block, schema_variant(schema, block, node), key);
    if (found != NULL) {
        return found;
    }
    int n = 0;
    const evl_row *rows = schema_block(schema, block, &n);
    for (int i = 0; i < n; i++) {
        if (strcmp(rows[i].key, key) == 0) {
            if (found != NULL && strcmp(found->unit, rows[i].unit) != 0) {
                return NULL;
            }
            found = found == NULL ? &rows[i] : found;
        }
    }
    return found;
}

const evl_row *row_at_path(const case_schema *schema, case_node *root, const char *path, case_node **node)
{
    CLEANUP_FREE char *copy = path_with_present_keys(path);
    char *rest = NULL;
    const char *block = CASE_ROOT;
    const evl_row *row = NULL;
    *node = root;
    for (char *segment = strtok_r(copy, ".", &rest); segment != NULL; segment = strtok_r(NULL, ".", &rest)) {
        const bool is_key = block != NULL;
        if (is_key) {
            row = row_of_key(schema, block, *node, segment);
        }
        if (row == NULL) {
            *node = NULL;
            return NULL;
        }
        const int i = *node == NULL || (*node)->kind == NODE_SCALAR ? -1 : node_step(*node, segment);
        *node = i < 0 ? NULL : (*node)->entries[i].value;
        block = block_below(row, !is_key);
    }
    return row;
}

bool case_base_convert(const case_base *base, const char *option, case_quantity *quantity, evl_error *error)
{
    const char *equals = strchr(option, '=');
    CLEANUP_FREE char *path =
        xasprintf("%.*s", (int)(equals == NULL ? strlen(option) : (size_t)(equals - option)), option);
    CLEANUP_FREE char *location = xasprintf("--convert %s", option);
    if (equals == NULL) {
        return evl_error_set(error, EVL_EXIT_USAGE, location, "has no '='; write --convert PATH=VALUE");
    }
    if (!case_base_has_path(base, path, error)) {
        CLEANUP_FREE char *why = xstrdup(error->message);
        return evl_error_set(error, EVL_EXIT_CASE, location, "%s", why);
    }
    case_node *node = NULL;
    const char *unit = NULL;
    const evl_row *row = row_at_path(base->schema, base->root, path, &node);
    const bool is_number = row != NULL && row->type <= EVL_NAMED;
    *quantity = (case_quantity){.unit = is_number ? row->unit : ""};
    const quantity_kind kind =
        quantity_read(equals + 1, is_number && row->type != EVL_INTEGER ? row->unit : NULL, &quantity->value, &unit);
    quantity->is_number = kind == QUANTITY_NUMBER || kind == QUANTITY_CONVERTED;
    quantity->has_unit = kind == QUANTITY_CONVERTED;
    if (kind != QUANTITY_OTHER_UNIT) {
        return true;
    }
    CLEANUP_FREE char *why = unit_refusal(row->unit, unit);
    return evl_error_set(error, EVL_EXIT_CASE, location, "%s", why);
}
