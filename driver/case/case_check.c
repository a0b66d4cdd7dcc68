/* Check of a tree against the schema, block by block: unknown keys, missing keys; fills in defaults and sorts the keys. */
#include "case/case_check.h"
#include "base/memory.h"
#include "base/suggest.h"
#include "base/words.h"
#include "case/former_keys.h"

#include <ctype.h>
#include <stdlib.h>
#include <string.h>

static bool check_block(const checker *checker, const char *block, case_node *node);

/** Check the number of elements against the schema. Oversized input is refused before any loop iterates over all of it. */
static bool check_count(const checker *checker, const evl_row *key, const case_node *node)
{
    const char *one = key->type == EVL_LIST ? "element" : "name",
               *several = key->type == EVL_LIST ? "elements" : "names";
    const bool few = node->n < (int)key->minimum;
    return (!few && node->n <= key->maximum) ||
           checker_refuse(checker, node->location, few ? "has %d %s, needs at least %.0f" : "has %d %s, may have %.0f",
                          node->n, node->n == 1 ? one : several, few ? key->minimum : key->maximum);
}

/** Check the elements of a list or a map. */
static bool check_elements(const checker *checker, const evl_row *key, case_node *node)
{
    const bool is_list = key->type == EVL_LIST;
    if (node->kind != (is_list ? NODE_SEQUENCE : NODE_MAPPING)) {
        return refuse_type(checker, node, is_list ? "a list" : "blocks by name, {name: {...}}", "");
    }
    bool good = check_count(checker, key, node);
    for (int i = 0; i < node->n && good; i++) {
        const case_entry *entry = &node->entries[i];
        CLEANUP_FREE char *name = is_list ? node_element_name(entry->value) : xstrdup(entry->key);
        const bool has_name = name != NULL && name[0] != '\0';
        const struct checker inner = checker_at_element(checker, has_name ? name : NULL, i);
        good = (is_list || check_name(checker, entry->key_location, entry->key)) &&
               check_block(&inner, key->holds, entry->value);
    }
    return good;
}

static bool check_value(const checker *checker, const evl_row *key, case_node *node)
{
    switch (key->type) {
    case EVL_BLOCK:
        return check_block(checker, key->holds, node);
    case EVL_LIST:
    case EVL_MAP:
        return check_elements(checker, key, node);
    default:
        return check_single_value(checker, key, node);
    }
}

static bool refuse_key(const checker *checker, const char *block, const case_entry *entry)
{
    int n = 0;
    CLEANUP_FREE const char **keys = schema_keys(checker->schema, block, &n);
    CLEANUP_FREE char *hint = suggest_phrase(entry->key, n, keys), *list = words_join(n, keys, ", ");
    if (strcmp(entry->key, "<<") == 0) {
        return checker_refuse(checker, entry->key_location,
                              "merge keys (<<) are not supported; write the keys out or use an alias");
    }
    const char *present = key_of_former(block, entry->key);
    if (present != NULL) {
        return checker_refuse(checker, entry->key_location,
                              "'%s' is the former name of '%s', which is given too; leave out '%s'", entry->key,
                              present, entry->key);
    }
    const bool is_like_one = hint[0] != '\0';
    return checker_refuse(checker, entry->key_location, "unknown key '%.64s'%s%s", entry->key,
                          is_like_one ? hint : "; known here: ", is_like_one ? "" : list);
}

static bool refuse_missing(const checker *checker, const evl_row *key, const case_node *node)
{
    return checker_refuse(checker, node->location, "'%s' is missing (%s%s%s%s)", key->key, key->text,
                          key->unit[0] == '\0' ? "" : " [", key->unit, key->unit[0] == '\0' ? "" : "]");
}

/** The default value as nodes at the location of the block. */
static case_node *default_value(const checker *checker, const evl_row *key, const case_node *node)
{
    if (key->type == EVL_NAME) {
        CLEANUP_FREE char *name = node_element_name(node); /* the one name with a default is {driving}-{driven} */
        return name == NULL ? NULL : node_create_scalar(node->arena, name, true, node->location);
    }
    const bool is_plain = isalnum((unsigned char)key->default_text[0]) && strpbrk(key->default_text, ":#,[]{}") == NULL;
    return is_plain ? node_create_scalar(node->arena, key->default_text, true,
                                         node->location) /* same result as from the parser */
                    : tree_load_text(node->arena, key->default_text, node->location, checker->error);
}

static bool check_key_names(const checker *checker, const char *block, const case_node *node)
{
    int n = 0;
    const evl_row *rows = schema_block(checker->schema, block, &n);
    for (int i = 0; i < node->n; i++) {
        int k = 0;
        while (k < n && strcmp(rows[k].key, node->entries[i].key) != 0) {
            k++;
        }
        if (k == n) {
            return refuse_key(checker, block, &node->entries[i]);
        }
    }
    return true;
}

/** Variants of a block that allow a key, separated by commas: a new string. */
static char *variants_with(const checker *checker, const char *block, const char *key)
{
    int n = 0;
    const evl_row *rows = schema_block(checker->schema, block, &n);
    char *all = xstrdup("");
    for (int i = 0; i < n; i++) {
        if (strcmp(rows[i].key, key) == 0) {
            CLEANUP_FREE char **words = NULL;
            const int n_words = words_split(rows[i].variants, &words);
            CLEANUP_FREE char *before = all, *more = words_join(n_words, (const char *const *)words, ", ");
            all = xasprintf("%s%s%s", before, before[0] == '\0' ? "" : ", ", more);
        }
    }
    return all;
}

/** Refuse a key that the selected variant does not allow (selector value NULL: its default applies). */
static bool refuse_variant(const checker *checker, const evl_row *selector, const case_entry *entry,
                           const case_node *value, const char *variant)
{
    CLEANUP_FREE char *known = variants_with(checker, selector->block, entry->key);
    if (value == NULL) {
        return checker_refuse(checker, entry->key_location,
                              "'%s' is not valid with '%s: %s', the default; it is valid with %s", entry->key,
                              selector->key, variant, known);
    }
    if (value->location.option != NULL && entry->key_location.option != value->location.option) {
        return checker_refuse(checker, entry->key_location, "'%s' does not go with --set %s; set the whole block",
                              entry->key, value->location.option);
    }
    return checker_refuse(checker, entry->key_location, "'%s' is not valid with '%s: %s'; it is valid with %s",
                          entry->key, selector->key, variant, known);
}

/** Find the variant from the selector, and refuse keys of other variants. */
static bool check_variant(const checker *checker, const char *block, const case_node *node, const char **variant)
{
    const evl_row *key = schema_selector(checker->schema, block);
    *variant = "";
    if (key == NULL) {
        return true;
    }
    const case_node *value = node_get(node, key->key);
    if (value == NULL && key->required) {
        return refuse_missing(checker, key, node);
    }
    if (value == NULL) {
        *variant = key->default_text;
    } else {
        const struct checker inner = checker_at(checker, key->key);
        if (!check_choice(&inner, key, value)) {
            return false;
        }
        *variant = value->text;
    }
    for (int i = 0; i < node->n; i++) {
        if (schema_find(checker->schema, block, *variant, node->entries[i].key) == NULL) {
            return refuse_variant(checker, key, &node->entries[i], value, *variant);
        }
    }
    return true;
}

/** Whether the key's condition on another key of the block is met. */
static bool has_what_it_needs(const evl_row *key, const case_node *node)
{
    return (row_needs(key) == NULL || node_find(node, row_needs(key)) >= 0) &&
           (row_excludes(key) == NULL || node_find(node, row_excludes(key)) < 0);
}

/** Refuse two alternative keys for the same quantity. */
static bool refuse_pair(const checker *checker, const case_entry *entry, const case_node *node, const char *other)
{
    char where[EVL_ERROR_LOCATION_LENGTH];
    location_text(checker->path, node->entries[node_find(node, other)].key_location, where);
    return checker_refuse(checker, entry->key_location, "'%s' conflicts with '%s' (%s); give one of them", entry->key,
                          other, where);
}

/** Refuse a key without the other key that it requires, or together with one that it excludes. */
static bool check_needs(const checker *checker, const char *block, const char *variant, const case_node *node)
{
    for (int i = 0; i < node->n; i++) {
        const case_entry *entry = &node->entries[i];
        const evl_row *row = schema_find(checker->schema, block, variant, entry->key);
        if (row != NULL && !has_what_it_needs(row, node)) {
            if (row_excludes(row) != NULL) {
                return refuse_pair(checker, entry, node, row_excludes(row));
            }
            return checker_refuse(checker, entry->key_location, "'%s' needs '%s' in the same block", entry->key,
                                  row_needs(row));
        }
    }
    return true;
}

static bool check_block(const checker *checker, const char *block, case_node *node)
{
    const char *variant = "";
    if (node->kind != NODE_MAPPING) {
        return refuse_type(checker, node, "a block of keys", "");
    }
    if (!check_key_names(checker, block, node) || !check_variant(checker, block, node, &variant) ||
        !check_needs(checker, block, variant, node)) {
        return false;
    }
    int n = 0;
    const evl_row *rows = schema_block(checker->schema, block, &n);
    for (int i = 0; i < n; i++) {
        if (row_in_variant(&rows[i], variant) && rows[i].required && node_find(node, rows[i].key) < 0) {
            return refuse_missing(checker, &rows[i], node);
        }
    }
    case_node *ordered = node_create(node->arena, NODE_MAPPING, node->location);
    bool good = true;
    for (int i = 0; i < n && good; i++) {
        const evl_row *row = &rows[i];
        if (!row_in_variant(row, variant) || !has_what_it_needs(row, node)) {
            continue;
        }
        const int at = node_find(node, row->key);
        case_node *value = at >= 0 ? node->entries[at].value : NULL;
        const case_location location = at >= 0 ? node->entries[at].key_location : node->location;
        if (value == NULL && row->default_text[0] != '\0') {
            value = default_value(checker, row, node);
        }
        if (value != NULL) {
            const struct checker inner = checker_at(checker, row->key);
            good = check_value(&inner, row, value);
            node_append(ordered, row->key, location, value);
            ordered->entries[ordered->n - 1].row = row;
            ordered->entries[ordered->n - 1].former = at >= 0 ? node->entries[at].former : NULL;
        }
    }
    *node = *ordered;
    return good;
}

bool schema_check(const case_schema *schema, const char *path, case_node *root, evl_error *error)
{
    const checker checker = {.schema = schema, .path = path, .error = error};
    return check_block(&checker, CASE_ROOT, root);
}
