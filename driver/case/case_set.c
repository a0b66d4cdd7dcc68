/* --set PATH=VALUE: one edit of the tree. */
#include "base/memory.h"
#include "base/suggest.h"
#include "case/case_tree.h"
#include "case/former_keys.h"

#include <stdlib.h>
#include <string.h>

typedef struct {
    const char *option, *path; /**< path: with present keys */
    char location[EVL_ERROR_LOCATION_LENGTH];
    evl_error *error;
} set_edit;

/** @param n_parent  bytes of the path to the sequence at the start of the option */
static void refuse_element(const set_edit *edit, const case_node *sequence, int n_parent, const char *segment)
{
    ARENA_SCOPE memory_arena arena = {NULL};
    const char **names = arena_calloc(&arena, (size_t)sequence->n, sizeof *names);
    int n = 0;
    for (int i = 0; i < sequence->n; i++) {
        CLEANUP_FREE char *name = node_element_name(sequence->entries[i].value);
        if (name != NULL) {
            names[n++] = arena_copy(&arena, name);
        }
    }
    if (n == 0) {
        evl_error_set(edit->error, EVL_EXIT_CASE, edit->location, "%.*s has no element '%s'; it has %d, counted from 0",
                      n_parent, edit->path, segment, sequence->n);
    } else {
        CLEANUP_FREE char *hint = suggest_phrase(segment, n, names);
        evl_error_set(edit->error, EVL_EXIT_CASE, edit->location, "%.*s has no '%s'%s", n_parent, edit->path, segment,
                      hint);
    }
}

/** The entry of `node` named by `segment`, created (with a NULL value) if it does not exist. NULL if refused. */
static case_entry *enter(const set_edit *edit, case_node *node, int n_parent, const char *segment)
{
    const case_location location = {.option = edit->option};
    if (node->kind == NODE_SCALAR) {
        evl_error_set(edit->error, EVL_EXIT_CASE, edit->location, "%.*s is a single value and has no '%s'", n_parent,
                      edit->path, segment);
        return NULL;
    }
    const bool is_mapping = node->kind == NODE_MAPPING;
    const int i = node_step(node, segment);
    const bool is_next = !is_mapping && node_index(segment) == node->n; /* the element behind the last one */
    if (i < 0 && !is_mapping && !is_next) {
        refuse_element(edit, node, n_parent, segment);
        return NULL;
    }
    if (i < 0) {
        node_append(node, is_mapping ? segment : NULL, location, NULL);
        return &node->entries[node->n - 1];
    }
    return &node->entries[i];
}

/** Follow the path, which is split in place, and put `value` at its end. @return false if refused */
static bool put(const set_edit *edit, case_node *root, char *path, case_node *value)
{
    case_node *node = root;
    for (char *segment = path; segment != NULL;) {
        char *dot = strchr(segment, '.');
        if (dot != NULL) {
            *dot = '\0';
        }
        case_entry *entry = enter(edit, node, segment > path ? (int)(segment - path) - 1 : 0, segment);
        if (entry == NULL) {
            return false;
        }
        if (dot == NULL) {
            entry->value = value;
            entry->key_location = value->location;
        } else if (entry->value == NULL || node_is_null(entry->value)) {
            /* a number cannot be a key: the following is a list */
            const bool is_list = node_index(dot + 1) >= 0;
            entry->value = node_create(root->arena, is_list ? NODE_SEQUENCE : NODE_MAPPING, value->location);
        }
        node = entry->value;
        segment = dot == NULL ? NULL : dot + 1;
    }
    return true;
}

static bool has_empty_segment(const char *path)
{
    const size_t length = strlen(path);
    return length == 0 || path[0] == '.' || path[length - 1] == '.' || strstr(path, "..") != NULL;
}

bool tree_set(case_node *root, const char *option, evl_error *error)
{
    set_edit edit = {.option = option, .error = error};
    const case_location location = {.option = option};
    location_text("", location, edit.location);
    const char *equals = strchr(option, '=');
    CLEANUP_FREE char *path = equals == NULL ? NULL : xasprintf("%.*s", (int)(equals - option), option);
    if (path == NULL || has_empty_segment(path)) {
        return evl_error_set(error, EVL_EXIT_USAGE, edit.location,
                             "%s; write --set PATH=VALUE, such as --set wheels.pinion.teeth=20",
                             path == NULL ? "has no '='" : "has an empty part in its path");
    }
    CLEANUP_FREE char *present = path_with_present_keys(path), *segments = xstrdup(present);
    edit.path = present;
    case_node *value = tree_load_text(root->arena, equals + 1, location, error);
    const bool good = value != NULL && put(&edit, root, segments, value);
    if (good) {
        tree_use_present_keys(root);
    }
    return good;
}
