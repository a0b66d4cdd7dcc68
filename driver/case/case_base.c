/* A case parsed once: queries of a batch before its rows are tried. */
#include "case/case.h"

#include "base/memory.h"
#include "base/suggest.h"
#include "case/case_file.h"
#include "case/former_keys.h"

#include <stdlib.h>
#include <string.h>

/** @param text  NULL: read the file of this name */
static case_base *load(const char *name, const char *text, const case_schema *schema, evl_error *error)
{
    memset(error, 0, sizeof *error);
    case_base *base = xcalloc(1, sizeof *base);
    base->schema = schema;
    base->name = arena_copy(&base->arena, name);
    base->root =
        text == NULL ? tree_load_file(&base->arena, name, error) : tree_load_named(&base->arena, name, text, error);
    if (base->root == NULL) {
        case_base_delete(&base);
    }
    return base;
}

case_base *case_base_parse(const char *name, const char *text, const case_schema *schema, evl_error *error)
{
    return load(name, text, schema, error);
}

case_base *case_base_read(const char *path, const case_schema *schema, evl_error *error)
{
    return load(path, NULL, schema, error);
}

void case_base_delete(case_base **base)
{
    if (*base == NULL) {
        return;
    }
    arena_free(&(*base)->arena);
    free(*base);
    *base = NULL;
}

const char **case_base_elements(const case_base *base, const char *list, memory_arena *arena, int *n)
{
    const char *dot = strchr(list, '.');
    CLEANUP_FREE char *block = dot == NULL ? NULL : xasprintf("%.*s", (int)(dot - list), list);
    const case_node *root = dot == NULL ? base->root : node_get(base->root, block);
    const bool is_block = root != NULL && root->kind == NODE_MAPPING;
    const case_node *node = is_block ? node_get(root, dot == NULL ? list : dot + 1) : NULL;
    *n = node == NULL || node->kind != NODE_SEQUENCE ? 0 : node->n;
    const char **names = arena_calloc(arena, (size_t)*n, sizeof *names);
    for (int i = 0; i < *n; i++) {
        CLEANUP_FREE char *name = node_element_name(node->entries[i].value);
        names[i] = name != NULL ? arena_copy(arena, name) : arena_printf(arena, "%d", i);
    }
    return names;
}

const char *case_base_text(const case_base *base, const char *path)
{
    case_node *node = NULL;
    if (base->root != NULL) {
        (void)row_at_path(base->schema, base->root, path, &node);
    }
    return node != NULL && node->kind == NODE_SCALAR ? node->text : NULL;
}

/** Report that a block has no such key in any variant. */
static void refuse_key(const case_schema *schema, const char *block, const char *parent, const char *key,
                       evl_error *error)
{
    int n = 0;
    CLEANUP_FREE const char **keys = schema_keys(schema, block, &n);
    CLEANUP_FREE char *hint = suggest_phrase(key, n, keys);
    evl_error_set(error, EVL_EXIT_CASE, "", "%s has no key '%s'%s", parent[0] == '\0' ? "a case" : parent, key, hint);
}

/** Follow a path from a block of the schema downwards; `parent` is the part already followed. */
static bool walk(const case_schema *schema, const char *block, const char *parent, const char *path, evl_error *error)
{
    const size_t length = strcspn(path, ".");
    CLEANUP_FREE char *segment = xasprintf("%.*s", (int)length, path);
    const char *rest = path[length] == '.' ? path + length + 1 : NULL;
    bool good = false, is_known = false;
    int n = 0;
    const evl_row *rows = schema_block(schema, block, &n);
    for (int i = 0; i < n && !good; i++) {
        const evl_row *key = &rows[i];
        if (strcmp(key->key, segment) != 0) {
            continue;
        }
        is_known = true;
        const char *inner = rest;
        if (inner != NULL && (key->type == EVL_LIST || key->type == EVL_MAP)) { /* an element, which the base checks */
            const char *dot = strchr(inner, '.');
            inner = dot == NULL ? NULL : dot + 1;
        }
        const int walked = (int)(inner == NULL ? strlen(path) : (size_t)(inner - path) - 1);
        CLEANUP_FREE char *here = xasprintf("%s%s%.*s", parent, parent[0] == '\0' ? "" : ".", walked, path);
        good = inner == NULL || key->type < EVL_BLOCK || walk(schema, key->holds, here, inner, error);
    }
    if (!is_known) {
        refuse_key(schema, block, parent, segment, error);
    }
    return good;
}

bool case_base_has_path(const case_base *base, const char *path, evl_error *error)
{
    memset(error, 0, sizeof *error);
    ARENA_SCOPE memory_arena arena = {NULL};
    const char *option = arena_printf(&arena, "%s=0", path);
    CLEANUP_FREE char *present = path_with_present_keys(path);
    return tree_set(node_copy(&arena, base->root), option, error) && walk(base->schema, CASE_ROOT, "", present, error);
}
