/* The table of all keys as a JSON Schema, draft 2020-12. Each block is a definition; keys of its variants are subject
 * to conditions on the selector. */
#include "base/json.h"
#include "base/words.h"
#include "case/case_json_value.h"
#include "case/former_keys.h"
#include "case/unit.h"

#include <string.h>

/* ---- a key ---- */

/** "meaning [unit], range; plausible range": editors show only this text. */
static void write_description(json_writer *json, const evl_row *row)
{
    char range[128], plausible[128];
    row_range_text(row, range);
    row_plausible_text(row, plausible);
    const bool has_unit = row->unit[0] != '\0', has_range = range[0] != '\0' && row->type < EVL_BLOCK;
    CLEANUP_FREE char *text = xasprintf("%s%s%s%s%s%s%s%s", row->text, has_unit ? " [" : "", row->unit,
                                        has_unit ? "]" : "", has_range ? ", " : "", has_range ? range : "",
                                        plausible[0] == '\0' ? "" : "; plausible: ", plausible);
    json_text(json, "description", text);
}

/** The default name of a mesh is omitted: it depends on other keys. */
static void write_default(json_writer *json, const evl_row *row)
{
    ARENA_SCOPE memory_arena arena = {NULL};
    evl_error error = {.code = EVL_EXIT_OK};
    if (row->default_text[0] != '\0' && row->type != EVL_NAME) {
        tree_write_json(json, "default",
                        tree_load_text(&arena, row->default_text, (case_location){.option = row->key}, &error));
    }
}

/** Write a key, also under its former name, which editors mark as deprecated. */
static void write_key(json_writer *json, const evl_row *row)
{
    const char *former = former_of_key(row->block, row->key);
    if (former != NULL) {
        json_open(json, former, '{');
        json_text(json, "title", row->key);
        json_truth(json, "deprecated", true);
        json_schema_value(json, row);
        json_close(json, '}');
    }
    json_open(json, row->key, '{');
    json_text(json, "title", row->key);
    write_description(json, row);
    write_default(json, row);
    if (strcmp(row->block, CASE_ROOT) == 0 && strcmp(row->key, "format") == 0) {
        json_integer(json, "const", CASE_FORMAT);
    } else {
        json_schema_value(json, row);
    }
    json_close(json, '}');
}

/* ---- a block ---- */

typedef struct {
    const char *name;
    int n, n_keys;
    const evl_row *rows;
    const char **keys; /**< each once */
} block;

/** Number of rows of a key; several if its meaning depends on the variant. */
static int count_rows(const block *block, const char *key)
{
    int n = 0;
    for (int i = 0; i < block->n; i++) {
        n += strcmp(block->rows[i].key, key) == 0 ? 1 : 0;
    }
    return n;
}

static void write_required(json_writer *json, const block *block, const char *variant)
{
    json_open(json, "required", '[');
    for (int i = 0; i < block->n; i++) {
        const evl_row *row = &block->rows[i];
        const bool is_of_all = !row_is_of_variants(row);
        if (row->required && (variant == NULL ? is_of_all : !is_of_all && row_in_variant(row, variant))) {
            json_text(json, NULL, row->key);
        }
    }
    json_close(json, ']');
}

/** Keys that require others. */
static void write_needs(json_writer *json, const block *block)
{
    json_open(json, "dependentRequired", '{');
    for (int i = 0; i < block->n; i++) {
        if (row_needs(&block->rows[i]) != NULL) {
            json_open(json, block->rows[i].key, '[');
            json_text(json, NULL, row_needs(&block->rows[i]));
            json_close(json, ']');
        }
    }
    json_close(json, '}');
}

/** Keys that exclude others. */
static void write_exclusions(json_writer *json, const block *block)
{
    json_open(json, "dependentSchemas", '{');
    for (int i = 0; i < block->n; i++) {
        if (row_excludes(&block->rows[i]) != NULL) {
            json_open(json, block->rows[i].key, '{');
            json_open(json, "properties", '{');
            json_truth(json, row_excludes(&block->rows[i]), false);
            json_close(json, '}');
            json_close(json, '}');
        }
    }
    json_close(json, '}');
}

/** For this value of the selector: the meaning of keys, and the keys that are not allowed. */
static void write_variant(json_writer *json, const case_schema *schema, const block *block, const evl_row *selector,
                          const char *variant)
{
    json_open(json, NULL, '{');
    json_open(json, "if", '{');
    json_open(json, "properties", '{');
    json_open(json, selector->key, '{');
    json_text(json, "const", variant);
    json_close(json, '}');
    json_close(json, '}');
    if (strcmp(selector->default_text, variant) != 0) {
        json_open(json, "required", '[');
        json_text(json, NULL, selector->key);
        json_close(json, ']');
    }
    json_close(json, '}');
    json_open(json, "then", '{');
    json_open(json, "properties", '{');
    for (int i = 0; i < block->n_keys; i++) {
        const evl_row *row = schema_find(schema, block->name, variant, block->keys[i]);
        if (row == NULL) {
            json_truth(json, block->keys[i], false);
        } else if (count_rows(block, block->keys[i]) > 1) {
            write_key(json, row);
        }
    }
    json_close(json, '}');
    write_required(json, block, variant);
    json_close(json, '}');
    json_close(json, '}');
}

static void write_variants(json_writer *json, const case_schema *schema, const block *block)
{
    const evl_row *selector = schema_selector(schema, block->name);
    if (selector == NULL) {
        return;
    }
    CLEANUP_FREE char **variants = NULL;
    const int n = words_split(selector->words, &variants);
    json_open(json, "allOf", '[');
    for (int i = 0; i < n; i++) {
        write_variant(json, schema, block, selector, variants[i]);
    }
    json_close(json, ']');
}

static void write_block(json_writer *json, const case_schema *schema, const char *name)
{
    block block = {.name = name};
    block.rows = schema_block(schema, name, &block.n);
    CLEANUP_FREE const char **keys = block.keys = schema_keys(schema, name, &block.n_keys);
    json_open(json, name, '{');
    json_text(json, "title", name);
    json_text(json, "type", "object");
    json_open(json, "properties", '{');
    for (int i = 0; i < block.n_keys; i++) {
        if (count_rows(&block, keys[i]) > 1) {
            json_truth(json, keys[i], true);
        } else {
            const evl_row *row = block.rows;
            while (strcmp(row->key, keys[i]) != 0) {
                row++;
            }
            write_key(json, row);
        }
    }
    json_close(json, '}');
    json_truth(json, "additionalProperties", false);
    write_required(json, &block, NULL);
    write_needs(json, &block);
    write_exclusions(json, &block);
    write_variants(json, schema, &block);
    json_close(json, '}');
}

/* ---- the whole ---- */

void schema_write_json(FILE *stream, const case_schema *schema)
{
    json_writer json = {.stream = stream};
    json_open(&json, NULL, '{');
    json_text(&json, "$schema", "https://json-schema.org/draft/2020-12/schema");
    json_text(&json, "title", "evolvent case");
    json_text(&json, "description", "Case file of evolvent: a gearbox and its simulation.");
    json_schema_reference(&json, NULL, CASE_ROOT);
    json_open(&json, "$defs", '{');
    for (int i = 0; i < schema->n; i++) {
        if (i == 0 || strcmp(schema->rows[i].block, schema->rows[i - 1].block) != 0) {
            write_block(&json, schema, schema->rows[i].block);
        }
    }
    for (int i = 0; unit_of_keys(i) != NULL; i++) {
        json_schema_quantity(&json, unit_of_keys(i));
    }
    json_close(&json, '}');
    json_close(&json, '}');
}
