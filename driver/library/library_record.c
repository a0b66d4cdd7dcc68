/* Records of the library: views of histories in memory. */
#include "base/memory.h"
#include "library/library.h"

#include <string.h>

_Static_assert(EVOLVENT_MOST_DIMENSIONS - NETCDF_MAX_RANK == 0, "every variable has room");

struct evolvent_record {
    history *history; /**< its arena owns the record */
    evolvent_variable *variables;
    evolvent_attribute *attributes;
    char *layout;
    size_t n_layout; /**< its length in bytes */
};

static evolvent_variable view(const history_variable *from)
{
    static const evolvent_type types[] = {
        [NETCDF_REAL] = EVOLVENT_REAL, [NETCDF_INTEGER] = EVOLVENT_INTEGER, [NETCDF_TEXT] = EVOLVENT_TEXT};
    const netcdf_variable *variable = &from->variable;
    evolvent_variable to = {.name = variable->name,
                            .units = variable->units,
                            .long_name = variable->long_name,
                            .symbol = variable->symbol,
                            .rates = variable->rates != NULL ? variable->rates : "",
                            .type = types[variable->type],
                            .is_of_events = from->is_of_events,
                            .rank = variable->rank,
                            .values = from->values,
                            .n_flags = variable->n_flags,
                            .flag_meanings = variable->n_flags > 0 ? variable->flag_meanings : ""};
    for (int i = 0; i < variable->rank; i++) {
        to.dimensions[i] = variable->dimensions[i]->name;
        to.lengths[i] = (size_t)variable->dimensions[i]->length;
    }
    return to;
}

static evolvent_attribute view_attribute(const history_attribute *from)
{
    if (from->text != NULL) {
        return (evolvent_attribute){from->key, EVOLVENT_TEXT, from->text, 0.0, 0};
    }
    const bool is_real = history_is_number(from);
    return (evolvent_attribute){from->key, is_real ? EVOLVENT_REAL : EVOLVENT_INTEGER, "", from->number,
                                is_real ? 0 : from->integer};
}

/* ---- the layout: numbers and terminated texts, one after the other ---- */

/** Copy bytes to an offset, unless the buffer is NULL. @return the offset behind them */
static size_t put(char *to, size_t at, const void *bytes, size_t n)
{
    if (to != NULL) {
        memcpy(to + at, bytes, n);
    }
    return at + n;
}

static size_t put_text(char *to, size_t at, const char *text)
{
    return put(to, at, text, strlen(text) + 1);
}

static size_t put_variable(char *to, size_t at, const evolvent_variable *variable)
{
    const int numbers[] = {(int)variable->type, variable->is_of_events, variable->rank, variable->n_flags};
    at = put(to, at, numbers, sizeof numbers);
    at = put_text(to, at, variable->name);
    at = put_text(to, at, variable->units);
    at = put_text(to, at, variable->long_name);
    at = put_text(to, at, variable->symbol);
    at = put_text(to, at, variable->rates);
    at = put_text(to, at, variable->flag_meanings);
    for (int i = 0; i < variable->rank; i++) {
        at = put_text(to, at, variable->dimensions[i]);
    }
    if (variable->type == EVOLVENT_TEXT) {
        const char *const *texts = variable->values;
        at = put(to, at, &variable->lengths[0], sizeof variable->lengths[0]);
        for (size_t i = 0; i < variable->lengths[0]; i++) {
            at = put_text(to, at, texts[i]);
        }
    }
    return at;
}

/** Write the layout, or with NULL compute its length. */
static size_t write_layout(char *to, int n, const evolvent_variable *variables)
{
    size_t at = 0;
    for (int i = 0; i < n; i++) {
        at = put_variable(to, at, &variables[i]);
    }
    return at;
}

evolvent_record *library_record(history *history)
{
    if (history == NULL) {
        return NULL;
    }
    memory_arena *arena = &history->body.arena;
    evolvent_record *record = arena_calloc(arena, 1, sizeof *record);
    record->history = history;
    record->variables = arena_calloc(arena, (size_t)history->n_variables, sizeof *record->variables);
    record->attributes = arena_calloc(arena, (size_t)history->n_attributes, sizeof *record->attributes);
    for (int i = 0; i < history->n_variables; i++) {
        record->variables[i] = view(&history->variables[i]);
    }
    for (int i = 0; i < history->n_attributes; i++) {
        record->attributes[i] = view_attribute(&history->attributes[i]);
    }
    record->n_layout = write_layout(NULL, history->n_variables, record->variables);
    record->layout = arena_packed(arena, record->n_layout, 1);
    (void)write_layout(record->layout, history->n_variables, record->variables);
    return record;
}

const evolvent_variable *evolvent_record_variables(const evolvent_record *record, int *n)
{
    *n = record->history->n_variables;
    return record->variables;
}

const evolvent_attribute *evolvent_record_attributes(const evolvent_record *record, int *n)
{
    *n = record->history->n_attributes;
    return record->attributes;
}

const void *evolvent_record_layout(const evolvent_record *record, size_t *size)
{
    *size = record->n_layout;
    return record->layout;
}

const evolvent_variable *evolvent_record_find(const evolvent_record *record, const char *name)
{
    for (int i = 0; i < record->history->n_variables; i++) {
        const evolvent_variable *variable = &record->variables[i];
        if (!variable->is_of_events && strcmp(variable->name, name) == 0) {
            return variable;
        }
    }
    return NULL;
}

void evolvent_record_free(evolvent_record *record)
{
    if (record != NULL) {
        history *history = record->history;
        history_free(&history);
    }
}
