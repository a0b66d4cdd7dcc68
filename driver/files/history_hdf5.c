#include "files/history.h"

#include "base/memory.h"
#include "base/progress.h"
#include "files/history_head_hdf5.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { FLUSH_SECONDS = 5 };

/** Say why writing failed; the first reason counts. @return false */
static bool fail(const history *history, evl_error *error)
{
    return output_file_refuse(history->file.partial_path, history->netcdf.system_error, history->netcdf.reason, error);
}

static void free_history(history *history)
{
    pool_free(&history->netcdf.pool);
    free(history);
}

history *history_create(const history_layout *layout, evl_error *error)
{
    output_file file;
    if (!output_file_open(&file, layout->path, error)) {
        return NULL;
    }
    history *history = xcalloc(1, sizeof *history);
    history->file = file;
    history->n_outputs = layout->n_outputs;
    history->n_states = layout->n_states;
    history->outputs = layout->outputs;
    for (int i = 0; i < layout->n_outputs; i++) {
        const int end = layout->outputs[i].offset + layout->outputs[i].count;
        history->n_values = end > history->n_values ? end : history->n_values;
    }
    history->row = pool_calloc(&history->netcdf.pool, 1 + (size_t)history->n_values, sizeof *history->row);
    history->event_row =
        pool_calloc(&history->netcdf.pool, EVENT_STATES + 2 * (size_t)layout->n_states, sizeof *history->event_row);
    history->last_flush = clock_seconds();
    if (!history_write_head(history, layout)) {
        (void)fail(history, error);
        output_file_drop(&history->file, true);
        free_history(history);
        return NULL;
    }
    return history;
}

/** Everything that is only in memory goes on file. */
static bool write_all(history *history, bool is_last)
{
    netcdf_file *netcdf = &history->netcdf;
    return series_write(&history->times, is_last) && dimensions_finish(&history->dimensions, netcdf) &&
           (!history->has_events ||
            (series_write(&history->events, is_last) && scale_list_users(netcdf, &history->side.scale)));
}

/** From time to time, so that most of a killed run can be read. */
static bool flush_if_due(history *history)
{
    const double now = clock_seconds();
    if (now - history->last_flush < FLUSH_SECONDS) {
        return true;
    }
    history->last_flush = now;
    return write_all(history, false) && netcdf_flush(&history->netcdf);
}

static bool write_static(history *history, const model_output *output, const double *values)
{
    const netcdf_variable variable = history_describe_output(history, output);
    if (output->is_integer && !netcdf_check_integers(&history->netcdf, output->name, output->count, values)) {
        return false; /* HDF5 would write the nearest one */
    }
    CLOSED const hid_t dataset = netcdf_define(&history->netcdf, history->netcdf.id, &variable, 0);
    /* HDF5 turns whole doubles into integers. */
    return dataset >= 0 && netcdf_write(&history->netcdf, dataset, H5T_NATIVE_DOUBLE, values);
}

static bool write_statics(history *history, const double *values)
{
    bool good = true;
    for (int i = 0; i < history->n_outputs && good; i++) {
        const model_output *output = &history->outputs[i];
        good = !output->is_static || output->count == 0 || write_static(history, output, values + output->offset);
    }
    return good;
}

bool history_put_finals(history *history, int n, const model_output *outputs, const double *values, evl_error *error)
{
    bool good = true;
    for (int i = 0; i < n && good; i++) {
        good = outputs[i].count == 0 || write_static(history, &outputs[i], values + outputs[i].offset);
    }
    return good || fail(history, error);
}

bool history_append(history *history, double place, const double *values, evl_error *error)
{
    history->row[0] = place;
    memcpy(history->row + 1, values, (size_t)history->n_values * sizeof *values);
    const bool good = (history->n_rows > 0 || write_statics(history, values)) &&
                      series_append(&history->times, history->row) && flush_if_due(history);
    history->n_rows++;
    return good || fail(history, error);
}

bool history_add_event(history *history, const history_event *event, evl_error *error)
{
    double *row = history->event_row;
    row[EVENT_NUMBER] = (double)history->n_events;
    row[EVENT_TIME] = event->t;
    row[EVENT_KIND] = event->kind;
    row[EVENT_MESH] = event->mesh;
    row[EVENT_FLANK] = event->flank;
    row[EVENT_TOOTH_PAIR] = event->tooth_pair;
    for (int i = 0; i < history->n_states; i++) {
        row[EVENT_STATES + 2 * i] = event->before[i];
        row[EVENT_STATES + 2 * i + 1] = event->after[i];
    }
    history->n_events++;
    return (series_append(&history->events, row) && flush_if_due(history)) || fail(history, error);
}

bool history_close(history **pointer, bool commit, int n_attributes, const history_attribute *attributes,
                   evl_error *error)
{
    history *history = *pointer;
    *pointer = NULL;
    bool good = write_all(history, true) && history_put_attributes(history, n_attributes, attributes) &&
                netcdf_flush(&history->netcdf) && netcdf_close(&history->netcdf);
    if (good) {
        good = output_file_close(&history->file, commit, error);
    } else {
        (void)fail(history, error);
        output_file_drop(&history->file, false);
    }
    free_history(history);
    return good;
}

void history_abandon(history **pointer)
{
    if (*pointer != NULL) {
        output_file_drop(&(*pointer)->file, false);
        free_history(*pointer);
        *pointer = NULL;
    }
}

const char *history_partial_path(const history *history)
{
    return history->file.partial_path;
}

const char *history_version(void)
{
    static char text[32];
    unsigned version[3] = {0};
    netcdf_library_version(version);
    (void)snprintf(text, sizeof text, "HDF5 %u.%u.%u", version[0], version[1], version[2]);
    return text;
}
