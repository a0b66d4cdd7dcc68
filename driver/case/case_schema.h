/** Schema of a case file: the table of all rows that describe the components. */
#pragma once

#include "case/case_tree.h"

#include <evolvent/description.h>

/** The block of the whole file. */
#define CASE_ROOT "case"

/** Required value of `format`. */
enum { CASE_FORMAT = 1 };

/** The table. It belongs to the model and exists as long as the program. */
typedef struct {
    int n;
    const evl_row *rows; /**< rows of a block are contiguous, the one that selects its variant first */
} case_schema;

/** Rows of a block. @return the first; NULL if there is no such block */
const evl_row *schema_block(const case_schema *schema, const char *block, int *n);
/** Keys of the block in all variants, each once: a new array. */
const char **schema_keys(const case_schema *schema, const char *block, int *n);
/** The row of a key of a block in a variant ("" if the block has none); NULL if there is none. */
const evl_row *schema_find(const case_schema *schema, const char *block, const char *variant, const char *key);
/** The row whose value selects the variant of a block; NULL if the block has no variants. */
const evl_row *schema_selector(const case_schema *schema, const char *block);
/** Whether the row is allowed in this variant. */
bool row_in_variant(const evl_row *row, const char *variant);
/** The other key of the block that this one requires; NULL if it requires none. */
const char *row_needs(const evl_row *row);
/** The other key of the block that this one excludes; NULL if there is none. */
const char *row_excludes(const evl_row *row);
/** Whether the row belongs only to some variants of its block. */
bool row_is_of_variants(const evl_row *row);
bool row_is_series(const evl_row *row);

/** "greater than 0", "from 3 to 10000": the range in words, "" if unbounded. */
void row_range_text(const evl_row *row, char text[128]);
/** "1 um to 20 mm", "up to 300 m/s": plausible range of magnitudes, "" if the row has none. */
void row_plausible_text(const evl_row *row, char text[128]);

/** Variant of a checked block, as used by schema_find. */
const char *schema_variant(const case_schema *schema, const char *block, const case_node *node);

/** Check a tree against the table, fill in the defaults, and put the keys in the table's order.
 *  @param path  the case file, for locations in messages
 *  @return false with the first fault in `error` */
bool schema_check(const case_schema *schema, const char *path, case_node *root, evl_error *error);

/** Write the table as a JSON Schema, draft 2020-12, for editors. schema_check refuses everything that it refuses. */
void schema_write_json(FILE *stream, const case_schema *schema);
/** Print the table as a Markdown reference. */
void schema_print(FILE *stream, const case_schema *schema);
