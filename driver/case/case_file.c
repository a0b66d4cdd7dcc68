#include "case/case_file.h"

#include "base/number.h"

#include <string.h>

case_file *case_file_create(const char *path, int n_set, const char *const *set_options)
{
    case_file *file = xcalloc(1, sizeof *file);
    file->path = arena_copy(&file->arena, path);
    file->n_options = n_set;
    file->options = arena_calloc(&file->arena, (size_t)n_set, sizeof *file->options);
    for (int i = 0; i < n_set; i++) {
        const size_t length = strlen(set_options[i]);
        file->options[i] = arena_calloc(&file->arena, length + NUMBER_TEXT_LENGTH, 1);
        memcpy(file->options[i], set_options[i], length);
    }
    return file;
}

bool case_file_check_format(const case_file *file, evl_error *error)
{
    const case_node *format = node_get(file->root, "format");
    double version = 0;
    if (format == NULL || format->kind != NODE_SCALAR || !format->plain ||
        number_read(format->text, &version) != NUMBER_FINITE || version == CASE_FORMAT) {
        return true; /* valid, or the schema check gives the better message */
    }
    char location[EVL_ERROR_LOCATION_LENGTH];
    location_text(file->path, format->location, location);
    return evl_error_set(error, EVL_EXIT_CASE, location, "format: is %.32s, but this evolvent reads format %d only",
                         format->text, CASE_FORMAT);
}

bool case_file_resolve(case_file *file, const case_schema *schema, evl_error *error)
{
    for (int i = 0; i < file->n_options; i++) {
        if (!tree_set(file->root, file->options[i], error)) {
            return false;
        }
    }
    return case_file_check_format(file, error) && schema_check(schema, file->path, file->root, error) &&
           case_resolve(schema, file->path, file->root, &file->description, error);
}

void description_clear(description *description)
{
    arena_free(&description->arena);
    memset(description, 0, sizeof *description);
}
