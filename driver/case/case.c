#include "case/case.h"

#include "base/memory.h"
#include "base/number.h"
#include "case/case_file.h"
#include "case/case_resolve.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { FORMAT = 1 };

/** Before anything else: a case of another format has other keys. */
static bool check_format(const case_file *file, evl_error *error)
{
    const case_node *format = node_get(file->root, "format");
    double version = 0;
    if (format == NULL || format->kind != NODE_SCALAR || !format->plain ||
        number_read(format->text, &version) != NUMBER_FINITE || version == FORMAT) {
        return true; /* good, or the schema says better what is wrong */
    }
    char place[EVL_ERROR_PLACE_LENGTH];
    place_text(file->path, format->place, place);
    evl_error_set(error, EVL_EXIT_CASE, place, "format: is %.32s, but this evolvent reads format %d only", format->text,
                  FORMAT);
    return false;
}

bool case_file_resolve(case_file *file, const case_schema *schema, const law_tables *laws, evl_error *error)
{
    for (int i = 0; i < file->n_options; i++) {
        if (!tree_set(file->root, file->options[i], error)) {
            return false;
        }
    }
    return check_format(file, error) && schema_check(schema, file->path, file->root, error) &&
           case_resolve(file->path, file->root, laws, &file->description, error);
}

case_file *case_file_create(const char *path, int n_set, const char *const *set_options)
{
    case_file *file = xcalloc(1, sizeof *file);
    file->path = xstrdup(path);
    file->n_options = n_set;
    file->options = xcalloc((size_t)n_set, sizeof *file->options);
    for (int i = 0; i < n_set; i++) {
        const size_t length = strlen(set_options[i]);
        file->options[i] = xcalloc(length + NUMBER_TEXT_LENGTH, 1);
        memcpy(file->options[i], set_options[i], length);
    }
    return file;
}

case_file *case_read(const char *path, int n_set, const char *const *set_options, const law_tables *laws,
                     evl_error *error)
{
    memset(error, 0, sizeof *error);
    case_file *file = case_file_create(path, n_set, set_options);
    case_schema *schema = schema_create(laws);
    file->root = tree_load_file(path, error);
    if (file->root != NULL && case_file_resolve(file, schema, laws, error)) {
        file->text = tree_text(file->root);
    } else {
        case_delete(&file);
    }
    schema_delete(&schema);
    return file;
}

void case_delete(case_file **file)
{
    if (*file == NULL) {
        return;
    }
    description_clear(&(*file)->description);
    node_delete(&(*file)->root);
    for (int i = 0; i < (*file)->n_options; i++) {
        free((*file)->options[i]);
    }
    free((*file)->options);
    free((*file)->numbers);
    free((*file)->text);
    free((*file)->path);
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
    return file->text;
}

void case_settle_integrator(case_file *file, integrator_kind integrator)
{
    if (file->description.simulation.integrator != INTEGRATOR_OPEN) {
        return;
    }
    file->description.simulation.integrator = integrator;
    if (file->text != NULL) {
        case_node *block = node_get(file->root, "simulation");
        node_append(block, "integrator", block->place,
                    node_create_scalar(integrator == INTEGRATOR_RADAU ? "radau" : "ida", true, block->place));
        free(file->text);
        file->text = tree_text(file->root);
    }
}

void case_settle_damping(case_file *file, int mesh, const law_tables *laws, const law_choice *settled)
{
    law_choice *choice = &file->description.meshes[mesh].damping;
    const kind_info *law = &laws->laws[LAWS_DAMPING][choice->law];
    for (int i = 0; i < law->n_parameters; i++) {
        if (!isnan(choice->parameters[i])) {
            continue;
        }
        choice->parameters[i] = settled->parameters[i];
        if (file->text != NULL) {
            case_node *block = node_get(node_get(file->root, "meshes")->entries[mesh].value, "damping");
            char number[NUMBER_TEXT_LENGTH];
            number_write(number, settled->parameters[i]);
            node_append(block, law->parameters[i].name, block->place, node_create_scalar(number, true, block->place));
            free(file->text);
            file->text = tree_text(file->root);
        }
    }
}

const case_node *case_root(const case_file *file)
{
    return file->root;
}

/* ---- messages of the model ---- */

/** Go to element `index` of the list `key`, whose name (or index) is added to the label. */
static const case_node *list_element(const case_node *block, const char *key, int index, char **label)
{
    const case_node *list = node_get(block, key);
    if (list == NULL || index < 0 || index >= list->n) {
        return block;
    }
    const case_node *element = list->entries[index].value;
    const char *name = node_get_text(element, "name");
    char *longer = name != NULL ? xasprintf("%s%s.%s.", *label, key, name) : xasprintf("%s%s.%d.", *label, key, index);
    free(*label);
    *label = longer;
    return element;
}

/** The deepest node along a dotted path that the case has. */
static const case_node *deepest(const case_node *block, const char *field)
{
    char *path = xstrdup(field);
    for (char *key = path; key != NULL;) {
        char *dot = strchr(key, '.');
        if (dot != NULL) {
            *dot = '\0';
        }
        const case_node *value = node_get(block, key);
        if (value == NULL) {
            break;
        }
        block = value;
        key = dot == NULL ? NULL : dot + 1;
    }
    free(path);
    return block;
}

/** Where a wheel's speed or a mesh's gap at the start stands: by name in the block of the start. NULL if it is about neither. */
static const case_node *find_start(const case_file *file, case_subject subject, int index, const char **field)
{
    const case_node *parts = node_get(file->root, subject == CASE_ABOUT_WHEEL ? "wheels" : "meshes");
    const bool is_start = index >= 0 && ((subject == CASE_ABOUT_WHEEL && strcmp(*field, "speeds") == 0) ||
                                         (subject == CASE_ABOUT_MESH && strcmp(*field, "gaps") == 0));
    const case_node *values =
        is_start ? node_get(node_get(node_get(file->root, "simulation"), "initial"), *field) : NULL;
    if (values != NULL) {
        *field = node_get_text(parts->entries[index].value, "name");
    }
    return values;
}

/** The block of a part of the case, and its label, which ends in a dot unless it is empty.
 *  @param[in,out] field  in that block */
static const case_node *find_part(const case_file *file, case_subject subject, int index, int load, const char **field,
                                  char **label)
{
    const case_node *block = file->root;
    const char *start = *field;
    const case_node *values = find_start(file, subject, index, field);
    if (values != NULL) {
        *label = xasprintf("simulation.initial.%s.", start);
        return values;
    }
    *label = xstrdup("");
    switch (subject) {
    case CASE_ABOUT_NOTHING:
        break;
    case CASE_ABOUT_WHEEL:
        block = list_element(block, "wheels", index, label);
        break;
    case CASE_ABOUT_LOAD:
        block = list_element(block, "wheels", index, label);
        block = list_element(block, "loads", load, label);
        break;
    case CASE_ABOUT_MESH:
        block = list_element(block, "meshes", index, label);
        break;
    case CASE_ABOUT_SHAFT:
        block = list_element(block, "shafts", index, label);
        break;
    case CASE_ABOUT_INITIAL:
        block = node_get(node_get(block, "simulation"), "initial");
        free(*label);
        *label = xstrdup("simulation.initial.");
        break;
    case CASE_ABOUT_HOUSING:
        block = node_get(block, "housing");
        free(*label);
        *label = xstrdup("housing.");
        break;
    }
    return block;
}

char *case_message(const case_file *file, case_subject subject, int index, int load, const char *field,
                   const char *message)
{
    char *label;
    (void)find_part(file, subject, index, load, &field, &label);
    char *name = xasprintf("%s%s", label, field);
    const size_t length = strlen(name);
    if (length > 0 && name[length - 1] == '.') {
        name[length - 1] = '\0';
    }
    char *text = xasprintf("%s%s%s", name, name[0] == '\0' ? "" : ": ", message);
    free(name);
    free(label);
    return text;
}

void case_refuse(const case_file *file, case_subject subject, int index, int load, const char *field,
                 const char *message, evl_error *error)
{
    char *label, place[EVL_ERROR_PLACE_LENGTH];
    char *text = case_message(file, subject, index, load, field, message);
    const case_node *block = find_part(file, subject, index, load, &field, &label);
    place_text(file->path, deepest(block, field)->place, place);
    evl_error_set(error, EVL_EXIT_CASE, place, "%s", text);
    free(text);
    free(label);
}
