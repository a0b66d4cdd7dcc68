#include "case/case_file.h"

/** Entries and numbers so far; both arrays are large enough for the whole tree. */
typedef struct {
    const case_schema *schema;
    int n, n_numbers;
    evl_entry *entries;
    double *numbers;
    const case_node *requested; /**< number whose index is requested */
    int index;                  /**< its index among the numbers */
} layout;

static void add_entry(layout *layout, const evl_row *row, int level, const char *name)
{
    layout->entries[layout->n++] = (evl_entry){.row = (int)(row - layout->schema->rows),
                                               .level = level,
                                               .name = name,
                                               .numbers = layout->numbers + layout->n_numbers};
}

/** Add a number to the last entry. */
static void add_number(layout *layout, const case_node *node)
{
    layout->index = node == layout->requested ? layout->n_numbers : layout->index;
    layout->numbers[layout->n_numbers++] = node_number(node);
    layout->entries[layout->n - 1].n++;
}

static void add_block(layout *layout, const case_node *node, int level);

/** Blocks of a list or map, named numbers, or references: one entry each. */
static void add_elements(layout *layout, const evl_row *row, const case_node *node, int level)
{
    for (int i = 0; i < node->n; i++) {
        const case_node *value = node->entries[i].value;
        const char *name = node->entries[i].key;
        if (row->type == EVL_LIST) {
            name = node_get_text(value, "name");
        } else if (row->type == EVL_REFERENCES) {
            name = value->text;
        }
        add_entry(layout, row, level, name);
        if (row->type == EVL_NAMED) {
            add_number(layout, value);
        } else if (row->type != EVL_REFERENCES) {
            add_block(layout, value, level + 1);
        }
    }
}

static void add_value(layout *layout, const evl_row *row, const case_node *node, int level)
{
    switch (row->type) {
    case EVL_LIST:
    case EVL_MAP:
    case EVL_NAMED:
    case EVL_REFERENCES:
        add_elements(layout, row, node, level);
        return;
    case EVL_BLOCK:
        add_entry(layout, row, level, NULL);
        add_block(layout, node, level + 1);
        return;
    case EVL_NUMBER:
    case EVL_INTEGER:
        if (!node_is_number(node)) { /* a word permitted in place of the number */
            add_entry(layout, row, level, node->text);
            return;
        }
        add_entry(layout, row, level, NULL);
        add_number(layout, node);
        return;
    default:
        add_entry(layout, row, level, node->text);
        for (int i = 0; i < node->n; i++) {
            add_number(layout, node->entries[i].value);
        }
    }
}

static void add_block(layout *layout, const case_node *node, int level)
{
    for (int i = 0; i < node->n; i++) {
        add_value(layout, node->entries[i].row, node->entries[i].value, level);
    }
}

/** Number of nodes of a tree, each with one entry and one number at most. */
static size_t count_nodes(const case_node *node)
{
    size_t n = 1;
    for (int i = 0; i < node->n; i++) {
        n += count_nodes(node->entries[i].value);
    }
    return n;
}

static layout lay_out(const case_schema *schema, const case_node *root, const case_node *requested, memory_arena *arena)
{
    const size_t most = count_nodes(root);
    layout layout = {.schema = schema,
                     .entries = arena_calloc(arena, most, sizeof *layout.entries),
                     .numbers = arena_calloc(arena, most, sizeof *layout.numbers),
                     .requested = requested,
                     .index = -1};
    add_block(&layout, root, 1);
    return layout;
}

void case_lay_out(const case_schema *schema, const case_node *root, description *description)
{
    const layout layout = lay_out(schema, root, NULL, &description->arena);
    description->n_entries = layout.n;
    description->entries = layout.entries;
    description->numbers = layout.numbers;
}

int case_number_index(const case_schema *schema, const case_node *root, const case_node *number)
{
    ARENA_SCOPE memory_arena arena = {NULL};
    return lay_out(schema, root, number, &arena).index;
}
