/* Content of a history, before there is a file. */
#include "base/words.h"
#include "files/history_body.h"

#include <stdlib.h>
#include <string.h>

enum { FORMAT = 1, ROWS = 8192, EVENT_ROWS = 256 };

static const char *const *copy_names(memory_arena *arena, size_t n, const char *const *names)
{
    const char **own = arena_calloc(arena, n, sizeof *own);
    for (size_t i = 0; i < n; i++) {
        own[i] = arena_copy(arena, names[i]);
    }
    return own;
}

static void copy_layout(history_body *history, const history_layout *source)
{
    memory_arena *arena = &history->arena;
    history_layout *layout = &history->layout;
    *layout = *source;
    history_attribute *attributes = arena_calloc(arena, (size_t)source->n_attributes, sizeof *attributes);
    for (int i = 0; i < source->n_attributes; i++) {
        attributes[i] = source->attributes[i];
        attributes[i].text = attributes[i].text == NULL ? NULL : arena_copy(arena, attributes[i].text);
    }
    history_coordinate *coordinates = arena_calloc(arena, (size_t)source->n_coordinates, sizeof *coordinates);
    for (int i = 0; i < source->n_coordinates; i++) {
        const size_t n = (size_t)source->coordinates[i].n;
        coordinates[i] = source->coordinates[i];
        if (source->coordinates[i].names != NULL) {
            coordinates[i].names = copy_names(arena, n, source->coordinates[i].names);
        } else {
            coordinates[i].values = arena_grow(arena, coordinates[i].values, n, n, sizeof(double));
        }
    }
    layout->attributes = attributes;
    layout->coordinates = coordinates;
}

/** Names of the outputs whose sum is the rate of one, also of those that the history does not contain; NULL: none. */
static const char *rates_of(history_body *history, const model_output *of)
{
    const history_layout *layout = &history->layout;
    const bool has_all = layout->n_all > 0;
    const int n = has_all ? layout->n_all : layout->n_outputs;
    const char *rates = NULL;
    for (int i = 0; i < n; i++) {
        const model_output *output = has_all ? &layout->all[i] : &layout->outputs[i];
        if (output->rate_of != NULL && output->count > 0 && strcmp(output->rate_of, of->name) == 0) {
            rates = rates == NULL ? output->name : arena_printf(&history->arena, "%s %s", rates, output->name);
        }
    }
    return rates;
}

static void plan_times(history_body *history, char *reason)
{
    series *times = &history->times;
    const history_layout *layout = &history->layout;
    const history_coordinate *axis = &layout->axis;
    series_init(times, reason, &history->arena, 1 + layout->n_outputs, (unsigned long long)layout->max_rows);
    const netcdf_variable variable =
        netcdf_describe(NETCDF_REAL, axis->name, axis->units, axis->symbol, axis->long_name);
    series_add_column(times, &variable, 0, 1);
    for (int i = 0; i < layout->n_outputs; i++) {
        const model_output *output = &layout->outputs[i];
        if (!output->is_static && output->count > 0) {
            netcdf_variable variable = dimensions_describe(&history->dimensions, output);
            variable.rates = rates_of(history, output);
            series_add_column(times, &variable, output->offset, output->count);
        }
    }
    series_start(times, ROWS);
}

static void plan_events(history_body *history, char *reason)
{
    series *events = &history->events;
    memory_arena *arena = &history->arena;
    const history_layout *layout = &history->layout;
    const netcdf_variable number =
        netcdf_describe(NETCDF_INTEGER, "event", "1", "event", "number of the event, from 0");
    netcdf_variable columns[EVENT_STATES] = {
        [EVENT_TIME] = netcdf_describe(NETCDF_REAL, "time", "s", "t", "model time of the event"),
        [EVENT_KIND] = netcdf_describe(NETCDF_INTEGER, "kind", "1", "kind", "what happened"),
        [EVENT_MESH] = netcdf_describe(NETCDF_INTEGER, "mesh", "1", "mesh", "index of the mesh, -1 if none"),
        [EVENT_FLANK] = netcdf_describe(NETCDF_INTEGER, "flank", "1", "flank", "0 drive, 1 coast, -1 without mesh"),
        [EVENT_TOOTH_PAIR] = netcdf_describe(NETCDF_INTEGER, "tooth_pair", "1", "tooth_pair",
                                             "pitches since the start, after the event; -1 without mesh"),
    };
    CLEANUP_FREE char *kinds = words_join(layout->n_event_kinds, layout->event_kinds, " ");
    columns[EVENT_KIND].n_flags = layout->n_event_kinds;
    columns[EVENT_KIND].flag_meanings = arena_copy(arena, kinds);
    series_init(events, reason, arena, 1 + EVENT_STATES + layout->n_states, 0);
    series_add_column(events, &number, 0, 1);
    for (int i = 0; i < EVENT_STATES; i++) {
        series_add_column(events, &columns[i], i, 1);
    }
    for (int i = 0; i < layout->n_states; i++) {
        const char *state = arena_copy(arena, layout->states[i].name),
                   *units = arena_copy(arena, layout->states[i].units);
        const char *long_name = arena_printf(arena, "state %s on both sides of the event", state);
        netcdf_variable variable = netcdf_describe(NETCDF_REAL, state, units, state, long_name);
        variable.rank = 1;
        variable.dimensions[0] = &history->side;
        series_add_column(events, &variable, EVENT_STATES + 2 * i, 2);
    }
    series_start(events, EVENT_ROWS);
    history->event_row = arena_calloc(arena, EVENT_STATES + 2 * (size_t)layout->n_states, sizeof *history->event_row);
}

/** All possible dimensions of a history, or those of another analysis. */
static void plan_dimensions(history_body *history)
{
    static const char *const sides[] = {"before", "after"};
    const history_layout *layout = &history->layout;
    const bool has_all = layout->n_all > 0;
    if (history->has_events) {
        dimensions_plan(&history->dimensions, DIMENSIONS_OF_HISTORY, layout->names,
                        has_all ? layout->n_all : layout->n_outputs, has_all ? layout->all : layout->outputs);
    } else {
        dimensions_plan_numbers(&history->dimensions, layout->n_coordinates, layout->coordinates);
    }
    if (layout->n_harmonics > 0) {
        dimensions_plan_harmonics(&history->dimensions, &history->arena, layout->n_harmonics);
    }
    history->side = (netcdf_dimension){.name = "side", .length = 2};
    history->sides =
        (dimension_values){.is_there = true,
                           .variable = netcdf_describe(NETCDF_TEXT, "side", "1", "side", "side of the event"),
                           .n = 2,
                           .names = sides};
}

void history_plan(history_body *history, const history_layout *source, char *reason)
{
    const history_layout *layout = &history->layout;
    copy_layout(history, source);
    history->has_events = layout->n_coordinates == 0;
    for (int i = 0; i < layout->n_outputs; i++) {
        const int end = layout->outputs[i].offset + layout->outputs[i].count;
        history->n_values = end > history->n_values ? end : history->n_values;
    }
    history->statics = arena_calloc(&history->arena, (size_t)history->n_values, sizeof *history->statics);
    plan_dimensions(history);
    plan_times(history, reason);
    if (history->has_events) {
        plan_events(history, reason);
    }
}

void history_set_statics(history_body *history, const double *values)
{
    memcpy(history->statics, values, (size_t)history->n_values * sizeof *values);
    history->has_statics = true;
}

void history_take_statics(history_body *history, const double *values, int stride)
{
    for (int v = 0; v < history->n_values && !history->has_statics; v++) {
        history->statics[v] = values[(size_t)v * (size_t)stride];
    }
    history->has_statics = true;
}

double history_event_row(history_body *history, const history_event *event)
{
    double *row = history->event_row;
    row[EVENT_TIME] = event->t;
    row[EVENT_KIND] = event->kind;
    row[EVENT_MESH] = event->mesh;
    row[EVENT_FLANK] = event->flank;
    row[EVENT_TOOTH_PAIR] = event->tooth_pair;
    for (int i = 0; i < history->layout.n_states; i++) {
        row[EVENT_STATES + 2 * i] = event->before[i];
        row[EVENT_STATES + 2 * i + 1] = event->after[i];
    }
    return (double)history->n_events++;
}

void history_body_free(history_body *history)
{
    series_free(&history->times);
    series_free(&history->events);
    arena_free(&history->arena);
}

void history_common_attributes(const history_layout *layout, history_attribute attributes[N_COMMON_ATTRIBUTES])
{
    attributes[0] = (history_attribute){"Conventions", .text = "CF-1.10"};
    attributes[1] = (history_attribute){"evolvent_format", .integer = FORMAT};
    attributes[2] = (history_attribute){"evolvent_kind", .text = layout->kind};
}

bool history_is_unchanged(const history_attribute *attribute, int n, const history_attribute *at_end)
{
    int other = 0;
    while (other < n && strcmp(at_end[other].key, attribute->key) != 0) {
        other++;
    }
    return other == n;
}
