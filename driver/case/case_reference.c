/* The tables of all keys and of all units as a Markdown reference. */
#include "base/memory.h"
#include "base/words.h"
#include "case/case_schema.h"
#include "case/unit.h"

#include <string.h>

static const char *const type_texts[] = {
    [EVL_NUMBER] = "number",
    [EVL_INTEGER] = "whole number",
    [EVL_PAIR] = "[x, y]",
    [EVL_TRIPLE] = "[x, y, z]",
    [EVL_QUATERNION] = "[w, x, y, z]",
    [EVL_SERIES] = "list of numbers",
    [EVL_KNOTS] = "list of numbers",
    [EVL_AT_KNOTS] = "list of numbers",
    [EVL_NAMED] = "{name: number}",
    [EVL_TEXT] = "text",
    [EVL_NAME] = "name",
    [EVL_REFERENCE] = "name of an object of the case",
    [EVL_REFERENCES] = "[name, name]",
    [EVL_CHOICE] = "one of",
    [EVL_BLOCK] = "block",
    [EVL_LIST] = "list of blocks",
    [EVL_MAP] = "{name: block}",
};

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
    char range[128], plausible[128];
    row_range_text(key, range);
    row_plausible_text(key, plausible);
    fprintf(stream, "| `%s` |", key->key);
    if (row_excludes(key) != NULL) {
        print_words(stream, row_excludes(key), " not ");
    } else {
        print_words(stream, row_needs(key) == NULL ? key->variants : row_needs(key), " ");
    }
    fprintf(stream, " | %s", type_texts[key->type]);
    print_words(stream, key->words, key->type == EVL_NUMBER ? " or " : " ");
    if (key->type >= EVL_BLOCK) {
        print_words(stream, key->holds, " ");
    }
    fprintf(stream, " | %s | %s | %s | ", key->unit, range, plausible);
    if (key->required) {
        fputs("required", stream);
    } else if (key->default_text[0] != '\0') {
        fprintf(stream, "`%s`", key->default_text);
    }
    fprintf(stream, " | %s |\n", key->text);
}

void unit_print(FILE *stream)
{
    fputs("| physical quantity | unit of the key | accepted units |\n|---|---|---|\n", stream);
    const char *key_unit = NULL;
    for (int i = 0; (key_unit = unit_of_keys(i)) != NULL; i++) {
        int n = 0;
        CLEANUP_FREE const char **names = unit_names(key_unit, NULL, &n);
        CLEANUP_FREE char *list = words_join(n, names, "`, `");
        const char *quote = key_unit[0] == '\0' ? "" : "`";
        fprintf(stream, "| %s | %s%s%s | `%s` |\n", unit_kind_name(key_unit), quote, key_unit, quote, list);
    }
}

void schema_print(FILE *stream, const case_schema *schema)
{
    const char *block = "";
    for (int i = 0; i < schema->n; i++) {
        const evl_row *key = &schema->rows[i];
        if (strcmp(key->block, block) != 0) {
            block = key->block;
            fprintf(stream, "%s### %s\n\n", i == 0 ? "" : "\n", block);
            fputs("| key | only with | type | unit | range | plausible | default | meaning |\n", stream);
            fputs("|---|---|---|---|---|---|---|---|\n", stream);
        }
        print_key(stream, key);
    }
}
