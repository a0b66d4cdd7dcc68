#include "case/case_file.h"

#include "base/memory.h"
#include "base/suggest.h"
#include "base/words.h"
#include "case/case_check.h"

#include <stdlib.h>
#include <string.h>

/* ---- names ---- */

/** The names of a list of blocks (its `name` keys) or of a map (its keys); without an arena the caller frees them. */
static const char **names_of(const case_node *node, memory_arena *arena)
{
    const char **names = arena_calloc(arena, (size_t)node->n, sizeof *names);
    for (int i = 0; i < node->n; i++) {
        names[i] = node->kind == NODE_MAPPING ? node->entries[i].key : node_get_text(node->entries[i].value, "name");
    }
    return names;
}

/** Read the names of a list of blocks (NULL: there is none) and refuse duplicates. */
static bool take_names(const checker *checker, const case_node *list, const char *key, const char *what,
                       memory_arena *arena, int *n, const char ***names)
{
    *n = list == NULL ? 0 : list->n;
    *names = list == NULL ? NULL : names_of(list, arena);
    const struct checker of_list = checker_at(checker, key);
    for (int i = 1; i < *n; i++) {
        if (words_index((*names)[i], i, *names) >= 0) {
            return checker_refuse(&of_list, node_get(list->entries[i].value, "name")->location,
                                  "the name '%s' is given to two %s; give each %s its own", (*names)[i], key, what);
        }
    }
    return true;
}

/** The word for one element of a list, such as wheel. */
static const char *one_of(const char *list)
{
    return strcmp(list, "materials") == 0 ? "material" : strcmp(list, "wheels") == 0 ? "wheel" : "mesh";
}

static bool check_reference(const checker *checker, const case_node *root, const char *list, const case_node *node)
{
    const case_node *among = node_get(root, list);
    CLEANUP_FREE const char **names = names_of(among, NULL);
    if (words_index(node->text, among->n, names) >= 0) {
        return true;
    }
    CLEANUP_FREE char *hint = suggest_phrase(node->text, among->n, names), *all = words_join(among->n, names, ", ");
    return checker_refuse(checker, node->location, "there is no %s '%.64s'%s; the case has %s", one_of(list),
                          node->text, hint, all);
}

/* ---- tables ---- */

/** Check that the knots of a table, such as times, increase. */
static bool check_knots(const checker *checker, const evl_row *row, const case_node *knots)
{
    if (knots->n < 2) {
        return checker_refuse(checker, knots->location, "has %d %s, needs at least 2", knots->n,
                              knots->n == 1 ? "value" : "values");
    }
    double last_knot = node_number(knots->entries[0].value);
    for (int i = 1; i < knots->n; i++) {
        const case_node *knot = knots->entries[i].value, *before = knots->entries[i - 1].value;
        const double number = node_number(knot);
        if (number <= last_knot) {
            CLEANUP_FREE char *found = node_quantity(knot, row->unit), *last = node_quantity(before, row->unit);
            const char *plural = row->key[strlen(row->key) - 1] == 's' ? "" : "s";
            return checker_refuse(checker, knot->location, "the %s%s of a table must increase: %s follows %s", row->key,
                                  plural, found, last);
        }
        last_knot = number;
    }
    return true;
}

/** Check that a table has as many values as knots, if it has both. */
static bool check_at_knots(const checker *checker, const case_node *block, const case_node *values)
{
    for (int i = 0; i < block->n; i++) {
        const case_entry *knots = &block->entries[i];
        if (knots->row->type == EVL_KNOTS && values->n != knots->value->n) {
            return checker_refuse(checker, values->location, "has %d values, but %s has %d; they need the same number",
                                  values->n, knots->key, knots->value->n);
        }
    }
    return true;
}

/** Check that the stresses of an S-N line decrease. */
static bool check_sn_line(const checker *checker, const case_node *sn)
{
    const case_node *stresses = node_get(sn, "stress");
    const struct checker inner = checker_at(checker, "stress");
    for (int i = 1; i < stresses->n; i++) {
        const case_node *stress = stresses->entries[i].value, *before = stresses->entries[i - 1].value;
        if (!(node_number(stress) < node_number(before))) {
            CLEANUP_FREE char *found = node_quantity(stress, "Pa"), *last = node_quantity(before, "Pa");
            return checker_refuse(
                &inner, stress->location,
                "the stresses of an S-N line must decrease: %s follows %s; order its points by cycles", found, last);
        }
    }
    return true;
}

/* ---- checks beyond single keys, in all blocks ---- */

static bool check_inside(const checker *checker, const case_node *root, const case_node *node);

static bool check_elements(const checker *checker, const case_node *root, const case_node *node)
{
    for (int i = 0; i < node->n; i++) {
        const case_node *value = node->entries[i].value;
        const char *name = node->kind == NODE_MAPPING ? node->entries[i].key : node_get_text(value, "name");
        const struct checker inner = checker_at_element(checker, name, i);
        if (!check_inside(&inner, root, value)) {
            return false;
        }
    }
    return true;
}

static bool check_row(const checker *checker, const case_node *root, const evl_row *row, const case_node *block,
                      const case_node *node)
{
    switch (row->type) {
    case EVL_REFERENCE:
        return check_reference(checker, root, row->holds, node);
    case EVL_REFERENCES:
        return check_reference(checker, root, row->holds, node->entries[0].value) &&
               check_reference(checker, root, row->holds, node->entries[1].value);
    case EVL_KNOTS:
        return check_knots(checker, row, node);
    case EVL_AT_KNOTS:
        return check_at_knots(checker, block, node);
    case EVL_BLOCK:
        return check_inside(checker, root, node) && (strcmp(row->holds, "sn") != 0 || check_sn_line(checker, node));
    case EVL_LIST:
    case EVL_MAP:
        return check_elements(checker, root, node);
    default:
        return true;
    }
}

static bool check_inside(const checker *checker, const case_node *root, const case_node *node)
{
    for (int i = 0; i < node->n; i++) {
        const case_entry *entry = &node->entries[i];
        const struct checker inner = checker_at(checker, entry->key);
        if (!check_row(&inner, root, entry->row, node, entry->value)) {
            return false;
        }
    }
    return true;
}

bool case_resolve(const case_schema *schema, const char *path, case_node *root, description *description,
                  evl_error *error)
{
    const checker checker = {.schema = schema, .path = path, .error = error};
    const struct checker of_housing = checker_at(&checker, "housing");
    const struct checker of_simulation = checker_at(&checker, "simulation");
    memory_arena *arena = &description->arena;
    description->title = node_get_text(root, "title");
    return take_names(&checker, node_get(root, "wheels"), "wheels", "wheel", arena, &description->n_wheels,
                      &description->wheels) &&
           take_names(&checker, node_get(root, "meshes"), "meshes", "mesh", arena, &description->n_meshes,
                      &description->meshes) &&
           take_names(&checker, node_get(root, "shafts"), "shafts", "shaft", arena, &description->n_shafts,
                      &description->shafts) &&
           take_names(&of_housing, node_get(node_get(root, "housing"), "accelerometers"), "accelerometers",
                      "accelerometer", arena, &description->n_accelerometers, &description->accelerometers) &&
           check_inside(&checker, root, root) &&
           case_resolve_simulation(&of_simulation, node_get(root, "simulation"), description);
}
