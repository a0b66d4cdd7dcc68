/* A tree against the schema, block by block: unknown keys, missing keys; defaults filled in, the table's order. */
#include "case/case_check.h"
#include "base/memory.h"
#include "base/suggest.h"
#include "base/words.h"

#include <ctype.h>
#include <stdlib.h>
#include <string.h>

static bool check_block(checker *checker, const char *block, case_node *node);

static bool check_count(const checker *checker, const evl_row *key, const case_node *node)
{
    return node->n >= (int)key->minimum ||
           checker_refuse(checker, node->place, "has %d %s, needs at least %d", node->n,
                          key->type == EVL_LIST ? (node->n == 1 ? "element" : "elements")
                                                : (node->n == 1 ? "name" : "names"),
                          (int)key->minimum);
}

static bool check_list(checker *checker, const evl_row *key, case_node *node)
{
    if (node->kind != NODE_SEQUENCE) {
        return refuse_type(checker, node, "a list", "");
    }
    if (!check_count(checker, key, node)) {
        return false;
    }
    for (int i = 0; i < node->n; i++) {
        char *name = node_element_name(node->entries[i].value);
        char *step = name == NULL || name[0] == '\0' ? xasprintf("%d", i) : xstrdup(name);
        const size_t above = checker_enter(checker, step);
        free(name);
        free(step);
        if (!check_block(checker, key->holds, node->entries[i].value)) {
            return false;
        }
        checker_leave(checker, above);
    }
    return true;
}

static bool check_map(checker *checker, const evl_row *key, case_node *node)
{
    if (node->kind != NODE_MAPPING) {
        return refuse_type(checker, node, "blocks by name, {name: {...}}", "");
    }
    if (!check_count(checker, key, node)) {
        return false;
    }
    for (int i = 0; i < node->n; i++) {
        const case_entry *entry = &node->entries[i];
        if (!check_name(checker, entry->key_place, entry->key)) {
            return false;
        }
        const size_t above = checker_enter(checker, entry->key);
        if (!check_block(checker, key->holds, entry->value)) {
            return false;
        }
        checker_leave(checker, above);
    }
    return true;
}

static bool check_value(checker *checker, const evl_row *key, case_node *node)
{
    switch (key->type) {
    case EVL_BLOCK:
        return check_block(checker, key->holds, node);
    case EVL_LIST:
        return check_list(checker, key, node);
    case EVL_MAP:
        return check_map(checker, key, node);
    default:
        return check_single_value(checker, key, node);
    }
}

/** The block's keys, each once; those of one variant, or all of them if it is NULL. */
static int collect_keys(const checker *checker, const char *block, const char *variant, const char **keys)
{
    int n = 0;
    for (int i = 0; i < checker->schema->n; i++) {
        const evl_row *row = &checker->schema->rows[i];
        bool is_new = strcmp(row->block, block) == 0 && (variant == NULL || row_in_variant(row, variant));
        for (int k = 0; k < n && is_new; k++) {
            is_new = strcmp(keys[k], row->key) != 0;
        }
        if (is_new) {
            keys[n++] = row->key;
        }
    }
    return n;
}

static bool refuse_key(const checker *checker, const char *block, const char *variant, const case_entry *entry)
{
    const char **keys = xcalloc((size_t)checker->schema->n, sizeof *keys);
    const int n = collect_keys(checker, block, variant, keys);
    char *hint = suggest_phrase(entry->key, n, keys);
    if (strcmp(entry->key, "<<") == 0) {
        (void)checker_refuse(checker, entry->key_place,
                             "merge keys (<<) are not supported; write the keys out or use an alias");
    } else if (hint[0] != '\0') {
        (void)checker_refuse(checker, entry->key_place, "unknown key '%.64s'%s", entry->key, hint);
    } else {
        char *list = words_join(n, keys, ", ");
        (void)checker_refuse(checker, entry->key_place, "unknown key '%.64s'; known here: %s", entry->key, list);
        free(list);
    }
    free(hint);
    free(keys);
    return false;
}

static bool refuse_missing(const checker *checker, const evl_row *key, const case_node *node)
{
    return checker_refuse(checker, node->place, "'%s' is missing (%s%s%s%s)", key->key, key->text,
                          key->unit[0] == '\0' ? "" : " [", key->unit, key->unit[0] == '\0' ? "" : "]");
}

/** The default value as nodes that stand where the block stands. */
static case_node *default_value(const checker *checker, const evl_row *key, const case_node *node)
{
    if (key->type == EVL_NAME) {
        char *name = node_element_name(node); /* the one name with a default is {driving}-{driven} */
        case_node *value = name == NULL ? NULL : node_create_scalar(name, true, node->place);
        free(name);
        return value;
    }
    const bool is_plain = isalnum((unsigned char)key->default_text[0]) && strpbrk(key->default_text, ":#,[]{}") == NULL;
    return is_plain ? node_create_scalar(key->default_text, true, node->place) /* the parser would say the same */
                    : tree_load_text(key->default_text, node->place, checker->error);
}

static bool check_key_names(const checker *checker, const char *block, const case_node *node)
{
    for (int i = 0; i < node->n; i++) {
        bool is_known = false;
        for (int k = 0; k < checker->schema->n && !is_known; k++) {
            const evl_row *row = &checker->schema->rows[k];
            is_known = strcmp(row->block, block) == 0 && strcmp(row->key, node->entries[i].key) == 0;
        }
        if (!is_known) {
            return refuse_key(checker, block, NULL, &node->entries[i]);
        }
    }
    return true;
}

/** A key that stands beside a selector (NULL: its default holds) with which it has no meaning. */
static bool refuse_variant(const checker *checker, const evl_row *selector, const case_entry *entry,
                           const case_node *value, const char *variant)
{
    if (value == NULL) {
        return checker_refuse(checker, entry->key_place, "'%s' does not go with '%s: %s', the default", entry->key,
                              selector->key, variant);
    }
    if (value->place.option != NULL && entry->key_place.option != value->place.option) {
        return checker_refuse(checker, entry->key_place, "'%s' does not go with --set %s; set the whole block",
                              entry->key, value->place.option);
    }
    return checker_refuse(checker, entry->key_place, "'%s' does not go with '%s: %s'", entry->key, selector->key,
                          variant);
}

/** Find the variant from the selector, and refuse keys of other variants. */
static bool check_variant(checker *checker, const char *block, const case_node *node, const char **variant)
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
        const size_t above = checker_enter(checker, key->key);
        if (!check_choice(checker, key, value)) {
            return false;
        }
        checker_leave(checker, above);
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
    return row_needs(key) == NULL || node_find(node, row_needs(key)) >= 0;
}

/** Refuse a key without the other key that gives it a meaning. */
static bool check_needs(const checker *checker, const char *block, const char *variant, const case_node *node)
{
    for (int i = 0; i < node->n; i++) {
        const case_entry *entry = &node->entries[i];
        const evl_row *row = schema_find(checker->schema, block, variant, entry->key);
        if (row != NULL && !has_what_it_needs(row, node)) {
            return checker_refuse(checker, entry->key_place, "'%s' needs '%s' beside it", entry->key, row_needs(row));
        }
    }
    return true;
}

static bool check_block(checker *checker, const char *block, case_node *node)
{
    const char *variant = "";
    if (node->kind != NODE_MAPPING) {
        return refuse_type(checker, node, "a block of keys", "");
    }
    if (!check_key_names(checker, block, node) || !check_variant(checker, block, node, &variant) ||
        !check_needs(checker, block, variant, node)) {
        return false;
    }
    const case_schema *schema = checker->schema;
    for (int i = 0; i < schema->n; i++) {
        const evl_row *row = &schema->rows[i];
        if (strcmp(row->block, block) == 0 && row_in_variant(row, variant) && row->required &&
            node_find(node, row->key) < 0) {
            return refuse_missing(checker, row, node);
        }
    }
    case_node ordered = {.kind = NODE_MAPPING};
    bool good = true;
    for (int i = 0; i < schema->n && good; i++) {
        const evl_row *row = &schema->rows[i];
        if (strcmp(row->block, block) != 0 || !row_in_variant(row, variant) || !has_what_it_needs(row, node)) {
            continue;
        }
        const int at = node_find(node, row->key);
        case_node *value = at >= 0 ? node->entries[at].value : NULL;
        const case_place place = at >= 0 ? node->entries[at].key_place : node->place;
        if (value == NULL && row->default_text[0] != '\0') {
            value = default_value(checker, row, node);
        }
        if (value != NULL) {
            const size_t above = checker_enter(checker, row->key);
            good = check_value(checker, row, value);
            if (good) {
                checker_leave(checker, above);
            }
            if (at >= 0) {
                node->entries[at].value = NULL;
            }
            node_append(&ordered, row->key, place, value);
        }
    }
    /* what is left of the old entries, and on failure the values not yet checked, goes */
    case_entry *old = node->entries;
    const int n_old = node->n;
    node->entries = ordered.entries;
    node->n = ordered.n;
    node->capacity = ordered.capacity;
    for (int i = 0; i < n_old; i++) {
        free(old[i].key);
        node_delete(&old[i].value);
    }
    free(old);
    return good;
}

bool schema_check(const case_schema *schema, const char *path, case_node *root, evl_error *error)
{
    checker checker = {.schema = schema, .path = path, .error = error};
    return check_block(&checker, CASE_ROOT, root);
}
