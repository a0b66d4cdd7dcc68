/* Histories in memory: history.h for the library, which does not use HDF5. */
#include "files/history_memory.h"

#include <stdlib.h>
#include <string.h>

static bool refuse(const history *history, evl_error *error)
{
    return evl_error_set(error, EVL_EXIT_IO, history->body.layout.path, "cannot be stored: %s", history->reason);
}

history *history_create(const history_layout *layout, evl_error *error)
{
    (void)error;
    history *history = xcalloc(1, sizeof *history);
    history_plan(&history->body, layout, history->reason);
    return history;
}

void history_put_statics(history *history, const double *values)
{
    history_set_statics(&history->body, values);
}

static bool append(history *history, series *rows, int n, const double *positions, const double *values, int stride,
                   evl_error *error)
{
    for (int done = 0; done < n;) {
        if (rows->filled == rows->capacity) {
            series_widen(rows);
        }
        const int taken = series_append(rows, n - done, positions + done, values + done, stride);
        if (taken < 0) {
            return refuse(history, error);
        }
        done += taken;
    }
    return true;
}

bool history_append_rows(history *history, int n, const double *positions, const double *values, int stride,
                         evl_error *error)
{
    history_take_statics(&history->body, values, stride);
    return append(history, &history->body.times, n, positions, values, stride, error);
}

bool history_append(history *history, double position, const double *values, evl_error *error)
{
    return history_append_rows(history, 1, &position, values, 1, error);
}

bool history_add_event(history *history, const history_event *event, evl_error *error)
{
    const double number = history_event_row(&history->body, event);
    return append(history, &history->body.events, 1, &number, history->body.event_row, 1, error);
}

/* ---- variables ---- */

/** Copies of the case's names, which may not live as long as the history. */
static const void *names_of(memory_arena *arena, int n, const char *const *names)
{
    const char **own = arena_calloc(arena, (size_t)n, sizeof *own);
    for (int i = 0; i < n; i++) {
        own[i] = arena_copy(arena, names[i]);
    }
    return own;
}

void history_store_variable(history *history, const netcdf_variable *variable, bool is_of_events, const void *values)
{
    memory_arena *arena = &history->body.arena;
    if (history->n_variables == history->capacity) {
        history->capacity = 2 * history->capacity + 64;
        history->variables = arena_grow(arena, history->variables, (size_t)history->n_variables,
                                        (size_t)history->capacity, sizeof *history->variables);
    }
    history_variable *own = &history->variables[history->n_variables++];
    *own = (history_variable){*variable, is_of_events, values};
    own->variable.name = arena_copy(arena, variable->name);
    own->variable.units = arena_copy(arena, variable->units);
    own->variable.symbol = arena_copy(arena, variable->symbol);
    own->variable.rates = variable->rates != NULL ? arena_copy(arena, variable->rates) : NULL;
    own->variable.long_name = arena_copy(arena, variable->long_name);
}

const void *history_numbers(history *history, netcdf_type type, int n, const double *numbers)
{
    if (type != NETCDF_INTEGER) {
        return numbers;
    }
    int *integers = arena_calloc(&history->body.arena, (size_t)n, sizeof *integers);
    for (int i = 0; i < n; i++) {
        integers[i] = (int)numbers[i];
    }
    return integers;
}

void history_store_coordinate(history *history, netcdf_dimension *dimension, const dimension_values *values,
                              bool is_of_events)
{
    netcdf_variable variable = values->variable;
    variable.rank = 1;
    variable.dimensions[0] = dimension;
    history_store_variable(history, &variable, is_of_events,
                           variable.type == NETCDF_TEXT
                               ? names_of(&history->body.arena, values->n, values->names)
                               : history_numbers(history, variable.type, values->n, values->numbers));
}

static bool add_statics(history *history, int n, const model_output *outputs, const double *values)
{
    for (int i = 0; i < n; i++) {
        const model_output *output = &outputs[i];
        const double *numbers = values + output->offset;
        if (!output->is_static || output->count == 0) {
            continue;
        }
        const netcdf_variable variable = dimensions_describe(&history->body.dimensions, output);
        if (output->is_integer && !netcdf_are_integers(history->reason, output->name, output->count, numbers)) {
            return false;
        }
        history_store_variable(history, &variable, false,
                               history_numbers(history, variable.type, output->count, numbers));
    }
    return true;
}

static void add_series(history *history, series *rows, bool is_of_events)
{
    for (int i = 0; i < rows->n_columns; i++) {
        history_store_variable(history, &rows->columns[i].variable, is_of_events, rows->columns[i].block);
    }
    rows->dimension = (netcdf_dimension){.name = rows->columns[0].variable.name, .length = rows->filled};
}

/** Add everything except what is known at the end. */
static bool add_all(history *history)
{
    history_body *body = &history->body;
    const history_layout *layout = &body->layout;
    for (int i = 0; i < N_DIMENSIONS; i++) {
        if (body->dimensions.values[i].is_there) {
            history_store_coordinate(history, &body->dimensions.of[i], &body->dimensions.values[i], false);
        }
    }
    if (body->has_events) {
        history_store_coordinate(history, &body->side, &body->sides, true);
    }
    if (body->has_statics && !add_statics(history, layout->n_outputs, layout->outputs, body->statics)) {
        return false;
    }
    add_series(history, &body->times, false);
    if (body->has_events) {
        add_series(history, &body->events, true);
    }
    return true;
}

bool history_put_finals(history *history, int n, const model_output *outputs, const double *values, evl_error *error)
{
    memory_arena *arena = &history->body.arena;
    int n_values = 0;
    for (int i = 0; i < n; i++) {
        const int end = outputs[i].offset + outputs[i].count;
        n_values = end > n_values ? end : n_values;
    }
    const double *in_memory = arena_grow(arena, values, (size_t)n_values, (size_t)n_values, sizeof *in_memory);
    const bool good = (history->n_variables > 0 || add_all(history)) && add_statics(history, n, outputs, in_memory);
    return good || refuse(history, error);
}

/* ---- the end ---- */

void history_store_attribute(history *history, const history_attribute *attribute)
{
    memory_arena *arena = &history->body.arena;
    const size_t n = (size_t)history->n_attributes++;
    history->attributes = arena_grow(arena, history->attributes, n, n + 1, sizeof *history->attributes);
    history_attribute *own = &history->attributes[n];
    *own = *attribute;
    own->key = arena_copy(arena, attribute->key);
    own->text = attribute->text == NULL ? NULL : arena_copy(arena, attribute->text);
}

static void add_attributes(history *history, int n, const history_attribute *at_end)
{
    const history_layout *layout = &history->body.layout;
    history_attribute common[N_COMMON_ATTRIBUTES];
    history_common_attributes(layout, common);
    for (int i = 0; i < N_COMMON_ATTRIBUTES; i++) {
        history_store_attribute(history, &common[i]);
    }
    for (int i = 0; i < layout->n_attributes; i++) {
        if (history_is_unchanged(&layout->attributes[i], n, at_end)) {
            history_store_attribute(history, &layout->attributes[i]);
        }
    }
    for (int i = 0; i < n; i++) {
        history_store_attribute(history, &at_end[i]);
    }
}

bool history_close(history **pointer, bool commit, int n_attributes, const history_attribute *attributes,
                   evl_error *error)
{
    (void)commit;
    history *history = *pointer;
    *pointer = NULL;
    if (history->n_variables == 0 && !add_all(history)) {
        (void)refuse(history, error);
        history_free(&history);
        return false;
    }
    add_attributes(history, n_attributes, attributes);
    *history->body.layout.in_memory = history;
    return true;
}

void history_free(history **pointer)
{
    if (*pointer != NULL) {
        history_body_free(&(*pointer)->body);
        free(*pointer);
        *pointer = NULL;
    }
}

void history_abandon(history **history)
{
    history_free(history);
}

const char *history_partial_path(const history *history)
{
    (void)history;
    return "";
}

const char *history_version(void)
{
    return "";
}
