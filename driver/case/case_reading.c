/* A case with numbers in engineering units. Reading it as a case gives the same numbers, unless a list was shortened. */
#include "case/case.h"

#include "base/memory.h"
#include "base/words.h"
#include "case/case_file.h"
#include "case/unit.h"

#include <string.h>

/** Longer lists of numbers are reduced to SHOWN_AT_ENDS values at each end. */
enum { MOST_SHOWN = 1000, SHOWN_AT_ENDS = 3 };

/** Placeholder of a blank during formatting, to prevent a line break between a number and its unit: U+E000, for private
 *  use. */
static const char BLANK[] = "\xee\x80\x80";

/** Replace blanks by BLANK: a new string. */
static char *without_blanks(const char *text)
{
    CLEANUP_FREE char **words = NULL;
    const int n = words_split(text, &words);
    return words_join(n, (const char *const *)words, BLANK);
}

/** Replace BLANK by blanks, in place. */
static void put_blanks(char *text)
{
    char *end = text;
    for (const char *c = text; *c != '\0'; end++) {
        const bool is_blank = strncmp(c, BLANK, sizeof BLANK - 1) == 0;
        *end = is_blank ? ' ' : *c;
        c += is_blank ? sizeof BLANK - 1 : 1;
    }
    *end = '\0';
}

static void write_numbers(const evl_row *row, case_node *node)
{
    if (node_is_number(node)) {
        CLEANUP_FREE char *text = quantity_text(node_number(node), row->unit), *joined = without_blanks(text);
        node->text = arena_copy(node->arena, joined);
    }
    for (int i = 0; i < node->n; i++) {
        write_numbers(row, node->entries[i].value);
    }
}

static void write_block(const case_schema *schema, const char *block, case_node *node)
{
    const char *variant = schema_variant(schema, block, node);
    for (int i = 0; i < node->n; i++) {
        const evl_row *row = schema_find(schema, block, variant, node->entries[i].key);
        case_node *value = node->entries[i].value;
        if (row->type == EVL_BLOCK) {
            write_block(schema, row->holds, value);
        } else if (row->type == EVL_LIST || row->type == EVL_MAP) {
            for (int k = 0; k < value->n; k++) {
                write_block(schema, row->holds, value->entries[k].value);
            }
        } else if (row->unit[0] != '\0') {
            write_numbers(row, value);
        }
    }
}

/** A copy with long lists shortened. */
static case_node *shortened(memory_arena *arena, const case_node *node)
{
    if (node->kind == NODE_SCALAR) {
        return node_copy(arena, node);
    }
    case_node *copy = node_create(arena, node->kind, node->location);
    const bool is_long =
        node->kind == NODE_SEQUENCE && node->n > MOST_SHOWN && node->entries[0].value->kind == NODE_SCALAR;
    for (int i = 0; i < node->n; i++) {
        const case_entry *entry = &node->entries[i];
        if (is_long && i == SHOWN_AT_ENDS) {
            const int n_cut = node->n - 2 * SHOWN_AT_ENDS;
            char *text = arena_printf(arena, "(%d%smore)", n_cut, BLANK);
            node_append(copy, NULL, node->location, node_create_scalar(arena, text, true, node->location));
            i += n_cut - 1;
            continue;
        }
        node_append(copy, entry->key, entry->key_location, shortened(arena, entry->value));
        copy->entries[copy->n - 1].row = entry->row;
    }
    return copy;
}

char *case_text_for_reading(const case_file *file, const case_schema *schema)
{
    ARENA_SCOPE memory_arena arena = {NULL};
    case_node *root = shortened(&arena, file->root);
    write_block(schema, CASE_ROOT, root);
    char *text = tree_text(root);
    put_blanks(text);
    return text;
}
