/* Conversion of files and option texts to nodes. */
#include "base/memory.h"
#include "case/case_tree.h"
#include "case/case_yaml.h"
#include "case/former_keys.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

enum { MOST_BYTES = 32 * 1024 * 1024 }; /* a file of that size is a mistake, such as a history instead of a case */

static char *read_bytes(FILE *file, const char *path, size_t *length, evl_error *error)
{
    struct stat status;
    if (fstat(fileno(file), &status) == 0 && S_ISDIR(status.st_mode)) {
        evl_error_set(error, EVL_EXIT_CASE, path, "is a directory, not a case file");
        return NULL;
    }
    size_t capacity = 16 * 1024;
    char *text = xcalloc(capacity, 1);
    size_t n = 0;
    while (n <= MOST_BYTES && !feof(file) && !ferror(file)) {
        if (n == capacity) {
            capacity *= 2;
            text = xrealloc(text, capacity, 1);
        }
        n += fread(text + n, 1, capacity - n, file);
    }
    if (ferror(file)) {
        evl_error_set(error, EVL_EXIT_CASE, path, "cannot be read: %s", strerror(errno));
    } else if (n > MOST_BYTES) {
        evl_error_set(error, EVL_EXIT_CASE, path, "larger than %d MiB: not a case file", MOST_BYTES / 1024 / 1024);
    } else {
        *length = n;
        return text;
    }
    free(text);
    return NULL;
}

static case_node *load_named(memory_arena *arena, const char *name, const char *text, size_t length, evl_error *error)
{
    case_node *root = tree_load_yaml(arena, name, (case_location){0}, text, length, error);
    if (root == NULL && error->code == EVL_EXIT_OK) {
        evl_error_set(error, EVL_EXIT_CASE, name, "is empty; a case starts with 'format: 1'");
    }
    if (root != NULL) {
        tree_use_present_keys(root);
    }
    return root;
}

case_node *tree_load_named(memory_arena *arena, const char *name, const char *text, evl_error *error)
{
    return load_named(arena, name, text, strlen(text), error);
}

const char *tree_file_name(const char *path)
{
    return strcmp(path, "-") == 0 ? "stdin" : path;
}

static case_node *load_stream(memory_arena *arena, const char *name, FILE *file, evl_error *error)
{
    size_t length = 0;
    CLEANUP_FREE char *text = read_bytes(file, name, &length, error);
    return text == NULL ? NULL : load_named(arena, name, text, length, error);
}

case_node *tree_load_file(memory_arena *arena, const char *path, evl_error *error)
{
    const char *name = tree_file_name(path);
    if (name != path) {
        return load_stream(arena, name, stdin, error);
    }
    FILE *file = fopen(path, "rb");
    if (file == NULL) {
        evl_error_set(error, EVL_EXIT_CASE, path, "cannot be read: %s", strerror(errno));
        return NULL;
    }
    case_node *root = load_stream(arena, path, file, error);
    (void)fclose(file);
    return root;
}

case_node *tree_load_text(memory_arena *arena, const char *text, case_location location, evl_error *error)
{
    case_node *root = tree_load_yaml(arena, NULL, location, text, strlen(text), error);
    return root == NULL && error->code == EVL_EXIT_OK ? node_create_scalar(arena, "", true, location) : root;
}
