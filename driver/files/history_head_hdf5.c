/* docs/result_format.md describes what this file and history_hdf5.c write. */
#include "files/history_head_hdf5.h"

#include "base/words.h"

#include <stdio.h>
#include <stdlib.h>

enum { FORMAT = 1, ROWS = 8192, EVENT_ROWS = 256 };

netcdf_variable history_describe_output(history *history, const model_output *output)
{
    netcdf_variable variable = netcdf_describe(output->is_integer ? NETCDF_INTEGER : NETCDF_REAL, output->name,
                                               output->units, output->symbol, output->long_name);
    dimensions_append(&history->dimensions, output, &variable);
    return variable;
}

bool history_put_attributes(history *history, int n, const history_attribute *attributes)
{
    netcdf_file *netcdf = &history->netcdf;
    bool good = true;
    for (int i = 0; i < n && good; i++) {
        const history_attribute *attribute = &attributes[i];
        good = attribute->text != NULL  ? netcdf_put_text(netcdf, netcdf->id, attribute->key, attribute->text)
               : attribute->number != 0 ? netcdf_put_number(netcdf, netcdf->id, attribute->key, attribute->number)
                                        : netcdf_put_integer(netcdf, netcdf->id, attribute->key, attribute->integer);
    }
    return good;
}

static void plan_times(history *history, const history_coordinate *axis, hsize_t max_rows)
{
    series *times = &history->times;
    series_init(times, &history->netcdf, history->netcdf.id, 1 + history->n_outputs, max_rows);
    const netcdf_variable variable =
        netcdf_describe(NETCDF_REAL, axis->name, axis->units, axis->symbol, axis->long_name);
    series_add_column(times, &variable, 0, 1);
    for (int i = 0; i < history->n_outputs; i++) {
        const model_output *output = &history->outputs[i];
        if (!output->is_static && output->count > 0) {
            const netcdf_variable variable = history_describe_output(history, output);
            series_add_column(times, &variable, 1 + output->offset, output->count);
        }
    }
    series_start(times, ROWS);
}

static void plan_events(history *history, hid_t group, const history_layout *layout)
{
    series *events = &history->events;
    series_init(events, &history->netcdf, group, EVENT_STATES + layout->n_states, 0);
    netcdf_variable columns[EVENT_STATES] = {
        [EVENT_NUMBER] = netcdf_describe(NETCDF_INTEGER, "event", "1", "event", "number of the event, from 0"),
        [EVENT_TIME] = netcdf_describe(NETCDF_REAL, "time", "s", "t", "model time of the event"),
        [EVENT_KIND] = netcdf_describe(NETCDF_INTEGER, "kind", "1", "kind", "what happened"),
        [EVENT_MESH] =
            netcdf_describe(NETCDF_INTEGER, "mesh", "1", "mesh", "index of the mesh, -1 if it concerns none"),
        [EVENT_FLANK] =
            netcdf_describe(NETCDF_INTEGER, "flank", "1", "flank", "0 drive, 1 coast, -1 if it concerns no mesh"),
        [EVENT_TOOTH_PAIR] = netcdf_describe(NETCDF_INTEGER, "tooth_pair", "1", "tooth_pair",
                                             "pitches since the start, after the event; -1 if it concerns no mesh"),
    };
    OWNED char *kinds = words_join(layout->n_event_kinds, layout->event_kinds, " ");
    columns[EVENT_KIND].n_flags = layout->n_event_kinds;
    columns[EVENT_KIND].flag_meanings = pool_copy(&history->netcdf.pool, kinds);
    for (int i = 0; i < EVENT_STATES; i++) {
        series_add_column(events, &columns[i], i, 1);
    }
    for (int i = 0; i < layout->n_states; i++) {
        memory_pool *pool = &history->netcdf.pool;
        const char *state = pool_copy(pool, layout->states[i].name), *units = pool_copy(pool, layout->states[i].units);
        const char *long_name = pool_printf(pool, "state %s on both sides of the event", state);
        netcdf_variable variable = netcdf_describe(NETCDF_REAL, state, units, state, long_name);
        variable.rank = 1;
        variable.dimensions[0] = &history->side;
        series_add_column(events, &variable, EVENT_STATES + 2 * i, 2);
    }
    series_start(events, EVENT_ROWS);
}

/** The group of events with its dimension. */
static bool start_events(history *history, const history_layout *layout)
{
    static const char *const sides[] = {"before", "after"};
    netcdf_file *netcdf = &history->netcdf;
    const hid_t group = netcdf_create_group(netcdf, "events");
    if (group < 0 ||
        !netcdf_define_names(netcdf, group, &history->side, "side", "side of the event", &(name_list){2, sides})) {
        return false;
    }
    plan_events(history, group, layout);
    return true;
}

bool history_write_head(history *history, const history_layout *layout)
{
    netcdf_file *netcdf = &history->netcdf;
    dimensions *dimensions = &history->dimensions;
    if (!netcdf_create(netcdf, history->file.partial_path)) {
        return false;
    }
    history->has_events = layout->n_coordinates == 0;
    const bool good = netcdf_put_text(netcdf, netcdf->id, "Conventions", "CF-1.10") &&
                      netcdf_put_integer(netcdf, netcdf->id, "evolvent_format", FORMAT) &&
                      netcdf_put_text(netcdf, netcdf->id, "evolvent_kind", layout->kind) &&
                      history_put_attributes(history, layout->n_attributes, layout->attributes) &&
                      (history->has_events
                           ? dimensions_define(dimensions, netcdf, DIMENSIONS_OF_HISTORY, layout->names,
                                               layout->n_all > 0 ? layout->n_all : layout->n_outputs,
                                               layout->n_all > 0 ? layout->all : layout->outputs)
                           : dimensions_define_numbers(dimensions, netcdf, layout->n_coordinates, layout->coordinates));
    const bool has_harmonics =
        good && (layout->n_harmonics == 0 || dimensions_define_harmonics(dimensions, netcdf, layout->n_harmonics));
    if (has_harmonics) {
        plan_times(history, &layout->axis, (hsize_t)layout->max_rows);
    }
    return has_harmonics && (!history->has_events || start_events(history, layout));
}
