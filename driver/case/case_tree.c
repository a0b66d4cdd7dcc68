#include "case/case_tree.h"

#include "base/memory.h"
#include "base/number.h"
#include "base/words.h"

#include <limits.h>
#include <stdlib.h>
#include <string.h>

case_node *node_create(memory_arena *arena, node_kind kind, case_location location)
{
    case_node *node = arena_packed(arena, 1, sizeof *node);
    *node = (case_node){.arena = arena, .kind = kind, .location = location};
    return node;
}

case_node *node_create_scalar(memory_arena *arena, const char *text, bool plain, case_location location)
{
    case_node *node = node_create(arena, NODE_SCALAR, location);
    node->text = arena_copy(arena, text);
    node->plain = plain;
    return node;
}

case_node *node_copy(memory_arena *arena, const case_node *node)
{
    case_node *copy = node_create(arena, node->kind, node->location);
    copy->text = node->text == NULL ? NULL : arena_copy(arena, node->text);
    copy->plain = node->plain;
    copy->n = copy->capacity = node->n;
    copy->entries = node->n == 0 ? NULL : arena_packed(arena, (size_t)node->n, sizeof *copy->entries);
    for (int i = 0; i < node->n; i++) {
        const case_entry *entry = &node->entries[i];
        copy->entries[i] = (case_entry){.key = entry->key == NULL ? NULL : arena_copy(arena, entry->key),
                                        .former = entry->former == NULL ? NULL : arena_copy(arena, entry->former),
                                        .key_location = entry->key_location,
                                        .value = node_copy(arena, entry->value),
                                        .row = entry->row};
    }
    return copy;
}

void node_append(case_node *node, const char *key, case_location key_location, case_node *value)
{
    if (node->n == node->capacity) {
        node->capacity = node->capacity == 0 ? 4 : 2 * node->capacity;
        node->entries =
            arena_grow(node->arena, node->entries, (size_t)node->n, (size_t)node->capacity, sizeof *node->entries);
    }
    node->entries[node->n++] = (case_entry){
        .key = key == NULL ? NULL : arena_copy(node->arena, key), .key_location = key_location, .value = value};
}

int node_find(const case_node *mapping, const char *key)
{
    for (int i = 0; mapping->kind == NODE_MAPPING && i < mapping->n; i++) {
        if (strcmp(mapping->entries[i].key, key) == 0) {
            return i;
        }
    }
    return -1;
}

case_node *node_get(const case_node *mapping, const char *key)
{
    const int i = node_find(mapping, key);
    return i < 0 ? NULL : mapping->entries[i].value;
}

const char *node_get_text(const case_node *mapping, const char *key)
{
    const case_node *value = node_get(mapping, key);
    return value == NULL ? NULL : value->text;
}

double node_number(const case_node *node)
{
    double value = 0;
    (void)number_read(node->text, &value);
    return value;
}

bool node_is_number(const case_node *node)
{
    double value = 0;
    return node->kind == NODE_SCALAR && node->plain && number_read(node->text, &value) == NUMBER_FINITE;
}

double node_get_number(const case_node *mapping, const char *key)
{
    return node_number(node_get(mapping, key));
}

char *node_quantity(const case_node *node, const char *unit)
{
    const char *gap = unit[0] == '\0' ? "" : " ";
    return node->written == NULL ? xasprintf("%s%s%s", node->text, gap, unit)
                                 : xasprintf("%s (%s%s%s)", node->written, node->text, gap, unit);
}

void node_convert(case_node *node, double value)
{
    char number[NUMBER_TEXT_LENGTH];
    number_write(number, value);
    node->written = node->text;
    node->text = arena_copy(node->arena, number);
    node->plain = true;
}

bool node_is_null(const case_node *node)
{
    static const char *const nulls[] = {"", "~", "null", "Null", "NULL"};
    return node->kind == NODE_SCALAR && node->plain &&
           words_index(node->text, sizeof nulls / sizeof *nulls, nulls) >= 0;
}

void node_describe(const case_node *node, char text[64])
{
    enum { SHOWN = 40 };
    if (node->kind == NODE_SEQUENCE) {
        (void)snprintf(text, 64, "a list");
    } else if (node->kind == NODE_MAPPING) {
        (void)snprintf(text, 64, "a block of keys");
    } else if (node_is_null(node)) {
        (void)snprintf(text, 64, "nothing");
    } else if (strlen(node->text) <= SHOWN) {
        (void)snprintf(text, 64, "'%s'", node->text);
    } else {
        (void)snprintf(text, 64, "'%.*s...'", words_cut(node->text, SHOWN), node->text);
    }
}

char *node_element_name(const case_node *element)
{
    const char *name = node_get_text(element, "name");
    if (name != NULL) {
        return xstrdup(name);
    }
    const char *driving = node_get_text(element, "driving"), *driven = node_get_text(element, "driven");
    return driving == NULL || driven == NULL ? NULL : xasprintf("%s-%s", driving, driven);
}

int node_index(const char *path)
{
    const size_t length = strcspn(path, ".");
    if (length == 0 || strspn(path, "0123456789") != length) {
        return -1;
    }
    const long index = strtol(path, NULL, 10);
    return index > INT_MAX ? INT_MAX : (int)index;
}

int node_step(const case_node *node, const char *segment)
{
    if (node->kind != NODE_SEQUENCE) {
        return node_find(node, segment);
    }
    for (int i = 0; i < node->n; i++) {
        CLEANUP_FREE char *name = node_element_name(node->entries[i].value);
        if (name != NULL && strcmp(name, segment) == 0) {
            return i;
        }
    }
    const int index = node_index(segment);
    return index < node->n ? index : -1;
}

void location_text(const char *path, case_location location, char text[EVL_ERROR_LOCATION_LENGTH])
{
    if (location.option != NULL) {
        (void)snprintf(text, EVL_ERROR_LOCATION_LENGTH, "--set %s", location.option);
    } else if (location.line > 0) {
        (void)snprintf(text, EVL_ERROR_LOCATION_LENGTH, "%s:%d:%d", path, location.line, location.column);
    } else {
        (void)snprintf(text, EVL_ERROR_LOCATION_LENGTH, "%s", path);
    }
}

void tree_write_json(json_writer *writer, const char *key, const case_node *node)
{
    double value = 0;
    if (node->kind == NODE_SCALAR && node->plain && number_read(node->text, &value) == NUMBER_FINITE) {
        json_number(writer, key, value);
    } else if (node->kind == NODE_SCALAR) {
        json_text(writer, key, node->text);
    } else {
        json_open(writer, key, node->kind == NODE_SEQUENCE ? '[' : '{');
        for (int i = 0; i < node->n; i++) {
            tree_write_json(writer, node->entries[i].key, node->entries[i].value);
        }
        json_close(writer, node->kind == NODE_SEQUENCE ? ']' : '}');
    }
}
