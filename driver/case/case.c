#include "case/case.h"

#include "base/memory.h"
#include "base/number.h"
#include "case/case_file.h"

#include <float.h>
#include <stdlib.h>
#include <string.h>

/** @param path, text  one of them; the other is NULL */
static case_file *load(const char *name, const char *path, const char *text, int n_set, const char *const *set_options,
                       const case_schema *schema, evl_error *error)
{
    memset(error, 0, sizeof *error);
    case_file *file = case_file_create(name, n_set, set_options);
    file->root =
        path != NULL ? tree_load_file(&file->arena, path, error) : tree_load_named(&file->arena, name, text, error);
    if (file->root != NULL && case_file_resolve(file, schema, error)) {
        case_lay_out(schema, file->root, &file->description);
        file->text = arena_calloc(&file->arena, 1, sizeof *file->text);
    } else {
        case_delete(&file);
    }
    return file;
}

case_file *case_read(const char *path, int n_set, const char *const *set_options, const case_schema *schema,
                     evl_error *error)
{
    return load(tree_file_name(path), path, NULL, n_set, set_options, schema, error);
}

case_file *case_parse(const char *name, const char *text, int n_set, const char *const *set_options,
                      const case_schema *schema, evl_error *error)
{
    return load(name, NULL, text, n_set, set_options, schema, error);
}

/** Discard the text after a change of the tree. */
static void forget_text(const case_file *file)
{
    if (file->text != NULL) {
        free(*file->text);
        *file->text = NULL;
    }
}

void case_delete(case_file **file)
{
    if (*file == NULL) {
        return;
    }
    description_clear(&(*file)->description);
    forget_text(*file); /* before the arena, which holds the pointer to it */
    arena_free(&(*file)->arena);
    free(*file);
    *file = NULL;
}

const description *case_description(const case_file *file)
{
    return &file->description;
}

const char *case_path(const case_file *file)
{
    return file->path;
}

const char *case_text(const case_file *file)
{
    if (file->text != NULL && *file->text == NULL) {
        *file->text = tree_text(file->root);
    }
    return file->text == NULL ? NULL : *file->text;
}

static void leave_out(case_node *mapping, const char *key)
{
    const int at = node_find(mapping, key);
    if (at >= 0) {
        mapping->n--;
        memmove(mapping->entries + at, mapping->entries + at + 1, (size_t)(mapping->n - at) * sizeof *mapping->entries);
    }
}

char *case_text_of_motion(const case_file *file)
{
    ARENA_SCOPE memory_arena arena = {NULL};
    case_node *root = node_copy(&arena, file->root);
    leave_out(root, "title");
    leave_out(node_get(root, "simulation"), "max_steps");
    return tree_text(root);
}

/** Add a value to the simulation block of a case that does not specify it. */
static void say(const case_file *file, const char *key, const char *value)
{
    case_node *block = node_get(file->root, "simulation");
    node_append(block, key, block->location, node_create_scalar(block->arena, value, true, block->location));
}

void case_settle_simulation(case_file *file, integrator_kind integrator, double tolerance)
{
    simulation_description *simulation = &file->description.simulation;
    const bool is_radau = integrator == INTEGRATOR_RADAU, has_text = file->text != NULL;
    const bool is_open = simulation->integrator == INTEGRATOR_OPEN, has_limit = simulation->max_step > 0;
    if (has_text && is_open) {
        say(file, "integrator", is_radau ? "radau" : "ida");
    }
    if (has_text && !has_limit) {
        char number[NUMBER_TEXT_LENGTH];
        number_write(number, IDA_LONGEST_STEP);
        say(file, "max_step", is_radau ? "none" : number);
    }
    if (has_text && (is_open || !has_limit)) {
        forget_text(file);
    }
    simulation->integrator = integrator;
    simulation->tolerance = tolerance;
    simulation->max_step = has_limit ? simulation->max_step : is_radau ? DBL_MAX : IDA_LONGEST_STEP;
}

void case_settle_damping(case_file *file, int mesh, const case_schema *schema, const double *parameters)
{
    if (file->text == NULL) {
        return;
    }
    case_node *block = node_get(node_get(file->root, "meshes")->entries[mesh].value, "damping");
    const char *law = schema_variant(schema, "damping", block);
    int n = 0, k = 0;
    const evl_row *rows = schema_block(schema, "damping", &n);
    for (int i = 1; i < n; i++) {
        if (!row_in_variant(&rows[i], law)) {
            continue;
        }
        if (node_get(block, rows[i].key) == NULL) {
            char number[NUMBER_TEXT_LENGTH];
            number_write(number, parameters[k]);
            node_append(block, rows[i].key, block->location,
                        node_create_scalar(block->arena, number, true, block->location));
            forget_text(file);
        }
        k++;
    }
}

const case_node *case_root(const case_file *file)
{
    return file->root;
}

/* ---- messages of the model ---- */

/** Deepest existing node along a dotted path. */
static const case_node *deepest(const case_node *block, const char *field)
{
    CLEANUP_FREE char *path = xstrdup(field);
    char *rest = NULL;
    for (char *key = strtok_r(path, ".", &rest); key != NULL; key = strtok_r(NULL, ".", &rest)) {
        const int step = node_step(block, key);
        if (step < 0) {
            break;
        }
        block = block->entries[step].value;
    }
    return block;
}

char *case_message(const char *field, const char *message)
{
    return xasprintf("%s%s%s", field, field[0] == '\0' ? "" : ": ", message);
}

bool case_refuse(const case_file *file, const char *field, const char *message, evl_error *error)
{
    char location[EVL_ERROR_LOCATION_LENGTH];
    CLEANUP_FREE char *text = case_message(field, message);
    location_text(file->path, deepest(file->root, field)->location, location);
    return evl_error_set(error, EVL_EXIT_CASE, location, "%s", text);
}
