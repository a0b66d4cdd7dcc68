#include "case/former_keys.h"

#include "base/memory.h"

#include <stdlib.h>
#include <string.h>

/** A renamed key. The blocks on the way to it are path segments; "*" stands for any element. */
typedef struct {
    const char *block;   /**< of the schema */
    const char *parents; /**< path of the block */
    const char *former, *key;
} renamed_key;

static const renamed_key renamed[] = {{"wheel", "wheels.*", "runout", "eccentricity"},
                                      {"simulation", "simulation", "numbers", "metrics"}};
enum { N_RENAMED = sizeof renamed / sizeof *renamed };

const char *key_of_former(const char *block, const char *former)
{
    for (int i = 0; i < N_RENAMED; i++) {
        if (strcmp(renamed[i].block, block) == 0 && strcmp(renamed[i].former, former) == 0) {
            return renamed[i].key;
        }
    }
    return NULL;
}

const char *former_of_key(const char *block, const char *key)
{
    for (int i = 0; i < N_RENAMED; i++) {
        if (strcmp(renamed[i].block, block) == 0 && strcmp(renamed[i].key, key) == 0) {
            return renamed[i].former;
        }
    }
    return NULL;
}

/* ---- paths ---- */

static bool fits(const char *pattern, size_t length, const char *segment, size_t segment_length)
{
    return (length == 1 && pattern[0] == '*') || (length == segment_length && strncmp(pattern, segment, length) == 0);
}

/** Offset of the segment behind the parents; 0 if the path does not go through them. */
static size_t offset_behind(const char *parents, const char *path)
{
    size_t at = 0;
    for (const char *pattern = parents;;) {
        const size_t length = strcspn(pattern, "."), segment_length = strcspn(path + at, ".");
        if (!fits(pattern, length, path + at, segment_length) || path[at + segment_length] == '\0') {
            return 0;
        }
        at += segment_length + 1;
        if (pattern[length] == '\0') {
            return at;
        }
        pattern += length + 1;
    }
}

/** The path with `to` in place of the key `from` behind the parents: a new string; NULL if that key is not on the path. */
static char *with_key(const char *parents, const char *from, const char *to, const char *path)
{
    const size_t at = offset_behind(parents, path), length = strcspn(path + at, ".");
    return at > 0 && fits(from, strlen(from), path + at, length)
               ? xasprintf("%.*s%s%s", (int)at, path, to, path + at + length)
               : NULL;
}

char *path_with_present_keys(const char *path)
{
    for (int i = 0; i < N_RENAMED; i++) {
        char *present = with_key(renamed[i].parents, renamed[i].former, renamed[i].key, path);
        if (present != NULL) {
            return present;
        }
    }
    return xstrdup(path);
}

char *path_with_former_keys(const char *path)
{
    for (int i = 0; i < N_RENAMED; i++) {
        char *former = with_key(renamed[i].parents, renamed[i].key, renamed[i].former, path);
        if (former != NULL) {
            return former;
        }
    }
    return NULL;
}

/* ---- texts ---- */

/** The key with which a line of a case's text starts; NULL if it is no former key. The renamed keys are at the second
 *  level, of which a line starts with two blanks. */
static const renamed_key *key_of_line(const char *line)
{
    for (int i = 0; i < N_RENAMED; i++) {
        const size_t n = strlen(renamed[i].former);
        if (strncmp(line, "  ", 2) == 0 && strncmp(line + 2, renamed[i].former, n) == 0 && line[2 + n] == ':') {
            return &renamed[i];
        }
    }
    return NULL;
}

void case_text_use_present_keys(char **text)
{
    char *result = NULL;
    size_t length = 0;
    FILE *stream = memory_open(&result, &length);
    for (const char *line = *text; *line != '\0';) {
        const char *end = strchr(line, '\n');
        const size_t n = end == NULL ? strlen(line) : (size_t)(end - line) + 1;
        const renamed_key *key = key_of_line(line);
        const size_t skipped = key == NULL ? 0 : 2 + strlen(key->former);
        (void)fprintf(stream, "%s%s", key == NULL ? "" : "  ", key == NULL ? "" : key->key);
        (void)fwrite(line + skipped, 1, n - skipped, stream);
        line += n;
    }
    memory_close(stream, &result);
    free(*text);
    *text = result;
}

/* ---- trees ---- */

static void rename_key(case_node *block, const renamed_key *renamed)
{
    const int i = node_find(block, renamed->former);
    if (i >= 0 && node_find(block, renamed->key) < 0) {
        case_entry *entry = &block->entries[i];
        entry->former = entry->key;
        entry->key = arena_copy(block->arena, renamed->key);
    }
}

static void rename_below(case_node *node, const char *parents, const renamed_key *renamed)
{
    if (*parents == '\0') {
        rename_key(node, renamed);
        return;
    }
    const size_t length = strcspn(parents, ".");
    const char *rest = parents + length + (parents[length] == '.' ? 1 : 0);
    for (int i = 0; i < node->n; i++) {
        const case_entry *entry = &node->entries[i];
        const char *key = entry->key == NULL ? "" : entry->key;
        if (fits(parents, length, key, strlen(key))) {
            rename_below(entry->value, rest, renamed);
        }
    }
}

void tree_use_present_keys(case_node *root)
{
    for (int i = 0; i < N_RENAMED; i++) {
        rename_below(root, renamed[i].parents, &renamed[i]);
    }
}
