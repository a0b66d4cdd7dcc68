/* The table of all keys as a Markdown reference. */
#include "case/case_schema.h"

#include <string.h>

static const char *type_text(const evl_row *key)
{
    switch ((evl_row_type)key->type) {
    case EVL_NUMBER:
        return "number";
    case EVL_INTEGER:
        return "whole number";
    case EVL_PAIR:
        return "[x, y]";
    case EVL_TRIPLE:
        return "[x, y, z]";
    case EVL_QUATERNION:
        return "[w, x, y, z]";
    case EVL_SERIES:
    case EVL_KNOTS:
    case EVL_AT_KNOTS:
        return "list of numbers";
    case EVL_NAMED:
        return "{name: number}";
    case EVL_TEXT:
        return "text";
    case EVL_NAME:
        return "name";
    case EVL_REFERENCE:
        return "name of a thing in the case";
    case EVL_REFERENCES:
        return "[name, name]";
    case EVL_CHOICE:
        return "one of";
    case EVL_BLOCK:
        return "block";
    case EVL_LIST:
        return "list of blocks";
    case EVL_MAP:
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

static void print_key(FILE *stream, const evl_row *key)
{
    char range[128];
    row_range_text(key, range);
    fprintf(stream, "| `%s` |", key->key);
    print_words(stream, row_needs(key) == NULL ? key->variants : row_needs(key), " ");
    fprintf(stream, " | %s", type_text(key));
    print_words(stream, key->words, key->type == EVL_NUMBER ? " or " : " ");
    if (key->type >= EVL_BLOCK) {
        print_words(stream, key->holds, " ");
    }
    fprintf(stream, " | %s | %s | ", key->unit, range);
    if (key->required) {
        fputs("required", stream);
    } else if (key->default_text[0] != '\0') {
        fprintf(stream, "`%s`", key->default_text);
    }
    fprintf(stream, " | %s |\n", key->text);
}

void schema_print(FILE *stream, const case_schema *schema)
{
    const char *block = "";
    for (int i = 0; i < schema->n; i++) {
        const evl_row *key = &schema->rows[i];
        if (strcmp(key->block, block) != 0) {
            block = key->block;
            fprintf(stream, "%s### %s\n\n", i == 0 ? "" : "\n", block);
            fputs("| key | only with | type | unit | range | default | meaning |\n", stream);
            fputs("|---|---|---|---|---|---|---|\n", stream);
        }
        print_key(stream, key);
    }
}
