/* Warnings of a valid case: former names of keys, and numbers outside the plausible ranges of their keys, whose unit is
 * probably wrong. */
#include "case/case.h"

#include "base/memory.h"
#include "base/number.h"
#include "case/case_check.h"
#include "case/case_file.h"
#include "case/unit.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/** First implausible number of a key, and the number of others. */
typedef struct {
    const evl_row *row;
    const case_node *node;
    char *label; /**< its path */
    int n_others;
} implausible;

typedef struct {
    memory_arena *arena;
    int n;
    implausible *found; /**< in the order of the file; those of --set options separate from those of the file */
    int n_former;
    const case_entry **former; /**< keys given under their former names */
} search;

static bool is_plausible(const evl_row *row, double value)
{
    const double size = fabs(value), slack = 1e-9; /* 1 um need not be 1e-6 to the last bit */
    return row->plausible_most <= 0 || size <= 0 ||
           (size >= row->plausible_least * (1 - slack) && size <= row->plausible_most * (1 + slack));
}

/* ---- text ---- */

/** Limit of a range: in the key's unit if that text is short, else in an engineering unit. */
static char *end_text(double value, const char *key_unit)
{
    CLEANUP_FREE char *reading = quantity_text(value, key_unit);
    const bool is_short = strlen(reading) <= strlen("100000 ") + strlen(key_unit);
    return (value >= 1 && value < 1e4) || !is_short
               ? xasprintf("%g%s%s", value, key_unit[0] == '\0' ? "" : " ", key_unit)
               : xstrdup(reading);
}

void row_plausible_text(const evl_row *row, char text[128])
{
    text[0] = '\0';
    if (row->plausible_most > 0) {
        CLEANUP_FREE char *least = end_text(row->plausible_least, row->unit),
                          *most = end_text(row->plausible_most, row->unit);
        (void)snprintf(text, 128, "%s%s%s", row->plausible_least > 0 ? least : "",
                       row->plausible_least > 0 ? " to " : "up to ", most);
    }
}

/** The number as written, with the first unit in which it is plausible, such as "16 um": a new string, NULL if there is
 *  none. */
static char *likely_text(const evl_row *row, const case_node *node)
{
    const char *written = node->written == NULL ? node->text : node->written;
    char *end = NULL;
    (void)strtod(written, &end);
    int n = 0;
    CLEANUP_FREE const char **names = unit_names(row->unit, NULL, &n);
    for (int i = 0; i < n; i++) {
        double value = 0;
        const char *unit = NULL;
        char *text = xasprintf("%.*s %s", (int)(end - written), written, names[i]);
        if (quantity_read(text, row->unit, &value, &unit) == QUANTITY_CONVERTED && is_plausible(row, value)) {
            return text;
        }
        free(text);
    }
    return NULL;
}

static char *warning_text(const char *path, const implausible *found)
{
    char where[EVL_ERROR_LOCATION_LENGTH], range[128];
    location_text(path, found->node->location, where);
    row_plausible_text(found->row, range);
    CLEANUP_FREE char *value = node_quantity(found->node, found->row->unit),
                      *likely = likely_text(found->row, found->node);
    CLEANUP_FREE char *remedy = likely == NULL ? xstrdup("check its unit") : xasprintf("did you mean %s?", likely);
    CLEANUP_FREE char *others = found->n_others == 0 ? xstrdup("")
                                : found->n_others == 1
                                    ? xstrdup(", as is another value of this key")
                                    : xasprintf(", as are %d other values of this key", found->n_others);
    return xasprintf("%s: %s: %s is outside the plausible range, %s%s; %s", where, found->label, value, range, others,
                     remedy);
}

static char *former_text(const char *path, const case_entry *entry)
{
    char where[EVL_ERROR_LOCATION_LENGTH];
    location_text(path, entry->key_location, where);
    return xasprintf("%s: '%s' is the former name of '%s' and will be refused by the next release; write %s", where,
                     entry->former, entry->key, entry->key);
}

/* ---- the search ---- */

static void note(search *search, const checker *checker, const evl_row *row, const case_node *node)
{
    char label[LABEL_LENGTH] = "";
    for (int i = 0; i < search->n; i++) {
        implausible *before = &search->found[i];
        if (before->row == row && before->node->location.option == node->location.option) {
            before->n_others++;
            return;
        }
    }
    (void)checker_label(checker, label);
    search->found =
        arena_grow(search->arena, search->found, (size_t)search->n, (size_t)search->n + 1, sizeof *search->found);
    search->found[search->n++] =
        (implausible){.row = row, .node = node, .label = arena_copy(search->arena, label), .n_others = 0};
}

static void note_former(search *search, const case_entry *entry)
{
    search->former = arena_grow(search->arena, (void *)search->former, (size_t)search->n_former,
                                (size_t)search->n_former + 1, sizeof *search->former);
    search->former[search->n_former++] = entry;
}

static bool is_outside(const evl_row *row, const case_node *node)
{
    double value = 0;
    return node->plain && number_read(node->text, &value) == NUMBER_FINITE && !is_plausible(row, value);
}

/** A number, or a list of numbers or numbers by name. */
static void search_numbers(search *search, const checker *checker, const evl_row *row, const case_node *node)
{
    if (node->kind == NODE_SCALAR && is_outside(row, node)) {
        note(search, checker, row, node);
    }
    for (int i = 0; i < node->n; i++) {
        const case_entry *entry = &node->entries[i];
        if (!is_outside(row, entry->value)) {
            continue;
        }
        const struct checker inner = checker_at_element(checker, entry->key, i);
        note(search, &inner, row, entry->value);
    }
}

static void search_block(search *search, const checker *checker, const case_node *block);

static void search_elements(search *search, const checker *checker, const case_node *node)
{
    for (int i = 0; i < node->n; i++) {
        const case_node *value = node->entries[i].value;
        const char *name = node->kind == NODE_MAPPING ? node->entries[i].key : node_get_text(value, "name");
        const struct checker inner = checker_at_element(checker, name, i);
        search_block(search, &inner, value);
    }
}

static void search_block(search *search, const checker *checker, const case_node *block)
{
    for (int i = 0; i < block->n; i++) {
        const case_entry *entry = &block->entries[i];
        const struct checker inner = checker_at(checker, entry->key);
        if (entry->row == NULL) { /* gaps that were not given */
            continue;
        }
        if (entry->former != NULL) {
            note_former(search, entry);
        }
        if (entry->row->type == EVL_BLOCK) {
            search_block(search, &inner, entry->value);
        } else if (entry->row->type == EVL_LIST || entry->row->type == EVL_MAP) {
            search_elements(search, &inner, entry->value);
        } else if (entry->row->plausible_most > 0) {
            search_numbers(search, &inner, entry->row, entry->value);
        }
    }
}

case_warning *case_warnings(const case_file *file, memory_arena *arena, int *n)
{
    search search = {.arena = arena};
    const checker checker = {.path = file->path};
    search_block(&search, &checker, file->root);
    case_warning *warnings = arena_calloc(arena, (size_t)search.n_former + (size_t)search.n, sizeof *warnings);
    *n = 0;
    for (int i = 0; i < search.n_former; i++) {
        const case_entry *entry = search.former[i];
        CLEANUP_FREE char *text = former_text(file->path, entry);
        warnings[(*n)++] = (case_warning){.text = arena_copy(arena, text), .option = entry->key_location.option};
    }
    for (int i = 0; i < search.n; i++) {
        CLEANUP_FREE char *text = warning_text(file->path, &search.found[i]);
        warnings[(*n)++] =
            (case_warning){.text = arena_copy(arena, text), .option = search.found[i].node->location.option};
    }
    return warnings;
}
