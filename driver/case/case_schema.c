#include "case/case_schema.h"

#include "base/memory.h"
#include "base/words.h"

#include <math.h>
#include <string.h>

const evl_row *schema_block(const case_schema *schema, const char *block, int *n)
{
    int first = 0;
    while (first < schema->n && strcmp(schema->rows[first].block, block) != 0) {
        first++;
    }
    *n = 0;
    while (first + *n < schema->n && strcmp(schema->rows[first + *n].block, block) == 0) {
        ++*n;
    }
    return *n == 0 ? NULL : &schema->rows[first];
}

const char **schema_keys(const case_schema *schema, const char *block, int *n)
{
    int n_rows = 0;
    const evl_row *rows = schema_block(schema, block, &n_rows);
    const char **keys = xcalloc((size_t)n_rows, sizeof *keys);
    *n = 0;
    for (int i = 0; i < n_rows; i++) {
        int k = 0;
        while (k < *n && strcmp(keys[k], rows[i].key) != 0) {
            k++;
        }
        keys[k] = rows[i].key;
        *n = k == *n ? k + 1 : *n;
    }
    return keys;
}

const char *row_needs(const evl_row *row)
{
    return row->variants[0] == '+' ? row->variants + 1 : NULL;
}

const char *row_excludes(const evl_row *row)
{
    return row->variants[0] == '-' ? row->variants + 1 : NULL;
}

bool row_is_of_variants(const evl_row *row)
{
    return row->variants[0] != '\0' && row_needs(row) == NULL && row_excludes(row) == NULL;
}

bool row_is_series(const evl_row *row)
{
    return row->type == EVL_SERIES || row->type == EVL_KNOTS || row->type == EVL_AT_KNOTS;
}

bool row_in_variant(const evl_row *row, const char *variant)
{
    return !row_is_of_variants(row) || words_contain(row->variants, variant);
}

const evl_row *schema_find(const case_schema *schema, const char *block, const char *variant, const char *key)
{
    int n = 0;
    const evl_row *rows = schema_block(schema, block, &n);
    for (int i = 0; i < n; i++) {
        if (strcmp(rows[i].key, key) == 0 && row_in_variant(&rows[i], variant)) {
            return &rows[i];
        }
    }
    return NULL;
}

const evl_row *schema_selector(const case_schema *schema, const char *block)
{
    int n = 0;
    const evl_row *rows = schema_block(schema, block, &n);
    for (int i = 1; i < n; i++) {
        if (row_is_of_variants(&rows[i])) {
            return rows;
        }
    }
    return n > 0 && strcmp(rows[0].key, "law") == 0 ? rows : NULL;
}

const char *schema_variant(const case_schema *schema, const char *block, const case_node *node)
{
    const evl_row *row = schema_selector(schema, block);
    const char *word = row == NULL ? "" : node_get_text(node, row->key);
    return word == NULL ? row->default_text : word;
}

void row_range_text(const evl_row *row, char text[128])
{
    const bool is_bounded_below = isfinite(row->minimum), is_bounded_above = isfinite(row->maximum);
    const char *low = row->minimum_open ? "greater than" : "at least";
    const char *high = row->maximum_open ? "less than" : "at most";
    text[0] = '\0';
    if (is_bounded_below && is_bounded_above && !row->minimum_open && !row->maximum_open) {
        (void)snprintf(text, 128, "from %g to %g", row->minimum, row->maximum);
    } else if (is_bounded_below && is_bounded_above) {
        (void)snprintf(text, 128, "%s %g and %s %g", low, row->minimum, high, row->maximum);
    } else if (is_bounded_below) {
        (void)snprintf(text, 128, "%s %g", low, row->minimum);
    } else if (is_bounded_above) {
        (void)snprintf(text, 128, "%s %g", high, row->maximum);
    }
}
