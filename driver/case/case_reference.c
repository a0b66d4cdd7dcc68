/* The table of all keys as a Markdown reference. */
#include "case/case_schema.h"

#include <string.h>

static const char *type_text(const case_key *key)
{
    switch (key->type) {
    case KEY_NUMBER:
        return "number";
    case KEY_INTEGER:
        return "whole number";
    case KEY_PAIR:
        return "[x, y]";
    case KEY_TRIPLE:
        return "[x, y, z]";
    case KEY_QUATERNION:
        return "[w, x, y, z]";
    case KEY_SERIES:
        return "list of numbers";
    case KEY_NAMED:
        return "{name: number}";
    case KEY_TEXT:
        return "text";
    case KEY_NAME:
        return "name";
    case KEY_REFERENCE:
        return "name of a thing in the case";
    case KEY_REFERENCES:
        return "[name, name]";
    case KEY_CHOICE:
        return "one of";
    case KEY_BLOCK:
        return "block";
    case KEY_LIST:
        return "list of blocks";
    case KEY_MAP:
        return "{name: block}";
    }
    return "";
}

static void print_words(FILE *stream, const char *words, const char *before)
{
    for (const char *start = words; *start != '\0';) {
        const size_t n = strcspn(start, " ");
        fprintf(stream, "%s`%.*s`", start == words ? before : ", ", (int)n, start);
        start += n + strspn(start + n, " ");
    }
}

static void print_key(FILE *stream, const case_key *key)
{
    char range[128];
    key_range_text(key, range);
    fprintf(stream, "| `%s` |", key->key);
    print_words(stream, key_needs(key) == NULL ? key->variants : key_needs(key), " ");
    fprintf(stream, " | %s", type_text(key));
    print_words(stream, key->words, key->type == KEY_NUMBER ? " or " : " ");
    print_words(stream, key->holds, " ");
    fprintf(stream, " | %s | %s | ", key->unit, range);
    if (key->required) {
        fputs("required", stream);
    } else if (key->default_text != NULL) {
        fprintf(stream, "`%s`", key->default_text);
    }
    fprintf(stream, " | %s |\n", key->text);
}

void schema_print(FILE *stream, const case_schema *schema)
{
    const char *block = "";
    for (int i = 0; i < schema->n; i++) {
        const case_key *key = &schema->keys[i];
        if (strcmp(key->block, block) != 0) {
            block = key->block;
            fprintf(stream, "%s### %s\n\n", i == 0 ? "" : "\n", block);
            fputs("| key | only with | type | unit | range | default | meaning |\n", stream);
            fputs("|---|---|---|---|---|---|---|\n", stream);
        }
        print_key(stream, key);
    }
}
