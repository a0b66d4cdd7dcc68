#include "files/history.h"

#include "base/memory.h"
#include "base/words.h"
#include "files/netcdf_hdf5.h"
#include "files/output_file.h"
#include "files/series_hdf5.h"

#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

/* docs/result_format.md describes what this file writes. */
enum { FORMAT = 1, ROWS = 8192, EVENT_ROWS = 256, FLUSH_SECONDS = 5 };
enum { EVENT_NUMBER, EVENT_TIME, EVENT_KIND, EVENT_MESH, EVENT_FLANK, EVENT_TOOTH_PAIR, EVENT_STATES };

struct history {
    output_file file;
    netcdf_file netcdf;
    netcdf_dimension wheel, mesh, shaft, axis, space, quaternion, pair, side;
    series times, events;
    int n_outputs, n_values, n_states;
    model_output *outputs;
    char *event_kinds; /**< as one string of words */
    double *row;       /**< [1 + n_values] time and outputs */
    double *event_row; /**< [EVENT_STATES + 2 n_states] */
    long long n_rows, n_events;
    time_t last_flush;
    char message[DAE_MESSAGE_LENGTH];
};

static time_t monotonic_seconds(void)
{
    struct timespec now;
    return clock_gettime(CLOCK_MONOTONIC, &now) == 0 ? now.tv_sec : 0;
}

/** Say why writing failed; the first reason counts. @return false */
static bool fail(history *history)
{
    if (history->message[0] == '\0') {
        output_file_describe(history->file.partial_path, history->netcdf.system_error, history->netcdf.reason,
                             history->message, sizeof history->message);
    }
    return false;
}

static void set_dimensions(history *history, const model_output *output, netcdf_variable *variable)
{
    const struct {
        int rank;
        netcdf_dimension *first, *second;
    } dims[] = {
        [MODEL_DIMS_NONE] = {0, NULL, NULL},
        [MODEL_DIMS_WHEEL] = {1, &history->wheel, NULL},
        [MODEL_DIMS_MESH] = {1, &history->mesh, NULL},
        [MODEL_DIMS_WHEEL_AXIS] = {2, &history->wheel, &history->axis},
        [MODEL_DIMS_MESH_AXIS] = {2, &history->mesh, &history->axis},
        [MODEL_DIMS_SPACE] = {1, &history->space, NULL},
        [MODEL_DIMS_QUATERNION] = {1, &history->quaternion, NULL},
        [MODEL_DIMS_WHEEL_SPACE] = {2, &history->wheel, &history->space},
        [MODEL_DIMS_MESH_PAIR] = {2, &history->mesh, &history->pair},
        [MODEL_DIMS_SHAFT] = {1, &history->shaft, NULL},
    };
    variable->rank = dims[output->dims].rank;
    variable->dimensions[0] = dims[output->dims].first;
    variable->dimensions[1] = dims[output->dims].second;
}

static netcdf_variable describe_output(history *history, const model_output *output)
{
    netcdf_variable variable = netcdf_describe(output->is_integer ? NETCDF_INTEGER : NETCDF_REAL, output->name,
                                               output->units, output->symbol, output->long_name);
    set_dimensions(history, output, &variable);
    return variable;
}

/** A dimension whose coordinate variable holds names. */
static bool define_names(history *history, hid_t group, netcdf_dimension *dimension, const char *name,
                         const char *long_name, int n, const char *const *names)
{
    const netcdf_variable variable = netcdf_describe(NETCDF_TEXT, name, "1", name, long_name);
    *dimension = (netcdf_dimension){.length = (hsize_t)n};
    if (!netcdf_define_dimension(&history->netcdf, group, &variable, dimension, 0)) {
        return false;
    }
    const herr_t result = n == 0 ? 0
                                 : H5Dwrite(dimension->scale.dataset, history->netcdf.text, H5S_ALL, H5S_ALL,
                                            history->netcdf.transfer, names);
    return result < 0 ? netcdf_fail(&history->netcdf) : true;
}

static bool put_attributes(history *history, int n, const history_attribute *attributes)
{
    netcdf_file *netcdf = &history->netcdf;
    bool good = true;
    for (int i = 0; i < n && good; i++) {
        const history_attribute *attribute = &attributes[i];
        switch (attribute->kind) {
        case HISTORY_TEXT:
            good = netcdf_put_text(netcdf, netcdf->id, attribute->key, attribute->text);
            break;
        case HISTORY_INTEGER:
            good = netcdf_put_integer(netcdf, netcdf->id, attribute->key, attribute->integer);
            break;
        case HISTORY_REAL:
            good = netcdf_put_real(netcdf, netcdf->id, attribute->key, attribute->real);
            break;
        }
    }
    return good;
}

static void plan_times(history *history, hsize_t max_rows)
{
    series *times = &history->times;
    series_init(times, &history->netcdf, history->netcdf.id, 1 + history->n_outputs, max_rows);
    const netcdf_variable time = netcdf_describe(NETCDF_REAL, "time", "s", "t", "model time");
    series_add_column(times, &time, 0, 1);
    for (int i = 0; i < history->n_outputs; i++) {
        const model_output *output = &history->outputs[i];
        if (!output->is_static && output->count > 0) {
            const netcdf_variable variable = describe_output(history, output);
            series_add_column(times, &variable, 1 + output->offset, output->count);
        }
    }
    series_start(times, ROWS);
}

/** A state's name as CF wants it: angle_deviation[1] becomes angle_deviation_1. */
static void make_name(const char *state, char *name, size_t size)
{
    size_t length = 0;
    bool is_gap = false;
    for (; *state != '\0' && length + 2 < size; state++) {
        const bool is_letter = isalnum((unsigned char)*state) != 0;
        if (is_letter && is_gap && length > 0) {
            name[length++] = '_';
        }
        if (is_letter) {
            name[length++] = *state;
        }
        is_gap = !is_letter;
    }
    name[length] = '\0';
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
    history->event_kinds = words_join(layout->n_event_kinds, layout->event_kinds, " ");
    columns[EVENT_KIND].n_flags = layout->n_event_kinds;
    columns[EVENT_KIND].flag_meanings = history->event_kinds;
    for (int i = 0; i < EVENT_STATES; i++) {
        series_add_column(events, &columns[i], i, 1);
    }
    for (int i = 0; i < layout->n_states; i++) {
        const char *state = layout->state_names[i];
        char name[64], long_name[128];
        make_name(state, name, sizeof name);
        (void)snprintf(long_name, sizeof long_name, "state %s on both sides of the event", state);
        netcdf_variable variable = netcdf_describe(NETCDF_REAL, name, layout->state_units[i], state, long_name);
        variable.rank = 1;
        variable.dimensions[0] = &history->side;
        series_add_column(events, &variable, EVENT_STATES + 2 * i, 2);
    }
    series_start(events, EVENT_ROWS);
}

/** Whether there are outputs of these dimensions. */
static bool has_dims(const history_layout *layout, model_dims dims)
{
    bool has = false;
    for (int i = 0; i < layout->n_outputs; i++) {
        has = has || (layout->outputs[i].dims == dims && layout->outputs[i].count > 0);
    }
    return has;
}

/** Places of tooth pairs: drive_0, drive_1, ..., coast_0, ... */
static bool define_pairs(history *history, hid_t root, const history_layout *layout)
{
    char (*texts)[24] = xcalloc((size_t)layout->n_pairs, sizeof *texts);
    const char **names = xcalloc((size_t)layout->n_pairs, sizeof *names);
    for (int i = 0; i < layout->n_pairs; i++) {
        const bool is_drive = i < layout->n_drive_pairs;
        (void)snprintf(texts[i], sizeof texts[i], "%s_%d", is_drive ? "drive" : "coast",
                       is_drive ? i : i - layout->n_drive_pairs);
        names[i] = texts[i];
    }
    const bool good = define_names(history, root, &history->pair, "pair", "place of a tooth pair: flank and slot",
                                   layout->n_pairs, names);
    free(names);
    free(texts);
    return good;
}

/** Everything whose size is known: attributes, names, the group of events. */
static bool write_head(history *history, const history_layout *layout)
{
    static const char *const axes[] = {"x", "y"}, *const sides[] = {"before", "after"};
    static const char *const directions[] = {"x", "y", "z"}, *const components[] = {"w", "x", "y", "z"};
    netcdf_file *netcdf = &history->netcdf;
    if (!netcdf_create(netcdf, history->file.partial_path)) {
        return false;
    }
    const hid_t root = netcdf->id;
    const bool good =
        netcdf_put_text(netcdf, root, "Conventions", "CF-1.10") &&
        netcdf_put_integer(netcdf, root, "evolvent_format", FORMAT) &&
        put_attributes(history, layout->n_attributes, layout->attributes) &&
        define_names(history, root, &history->wheel, "wheel", "wheel", layout->n_wheels, layout->wheel_names) &&
        define_names(history, root, &history->mesh, "mesh", "mesh", layout->n_meshes, layout->mesh_names) &&
        (layout->n_shafts == 0 ||
         define_names(history, root, &history->shaft, "shaft", "shaft", layout->n_shafts, layout->shaft_names)) &&
        define_names(history, root, &history->axis, "axis", "axis of the housing frame", 2, axes) &&
        (!has_dims(layout, MODEL_DIMS_WHEEL_SPACE) ||
         define_names(history, root, &history->space, "space", "component of a vector in space", 3, directions)) &&
        (!has_dims(layout, MODEL_DIMS_QUATERNION) ||
         define_names(history, root, &history->quaternion, "quaternion", "component of a quaternion", 4, components)) &&
        (!has_dims(layout, MODEL_DIMS_MESH_PAIR) || define_pairs(history, root, layout));
    const hid_t group = good ? netcdf_create_group(netcdf, "events") : H5I_INVALID_HID;
    if (group < 0 || !define_names(history, group, &history->side, "side", "side of the event", 2, sides)) {
        return false;
    }
    plan_times(history, (hsize_t)layout->max_rows);
    plan_events(history, group, layout);
    return true;
}

static void free_history(history *history)
{
    series_free(&history->times);
    series_free(&history->events);
    scale_free(&history->wheel.scale);
    scale_free(&history->mesh.scale);
    scale_free(&history->shaft.scale);
    scale_free(&history->axis.scale);
    scale_free(&history->space.scale);
    scale_free(&history->quaternion.scale);
    scale_free(&history->pair.scale);
    scale_free(&history->side.scale);
    free(history->outputs);
    free(history->event_kinds);
    free(history->row);
    free(history->event_row);
    free(history);
}

history *history_create(const history_layout *layout, char message[DAE_MESSAGE_LENGTH])
{
    output_file file;
    if (!output_file_open(&file, layout->path, message, DAE_MESSAGE_LENGTH)) {
        return NULL;
    }
    history *history = xcalloc(1, sizeof *history);
    history->file = file;
    history->n_outputs = layout->n_outputs;
    history->n_states = layout->n_states;
    history->outputs = xcalloc((size_t)layout->n_outputs, sizeof *history->outputs);
    for (int i = 0; i < layout->n_outputs; i++) {
        history->outputs[i] = layout->outputs[i];
        const int end = layout->outputs[i].offset + layout->outputs[i].count;
        history->n_values = end > history->n_values ? end : history->n_values;
    }
    history->row = xcalloc(1 + (size_t)history->n_values, sizeof *history->row);
    history->event_row = xcalloc(EVENT_STATES + 2 * (size_t)layout->n_states, sizeof *history->event_row);
    history->last_flush = monotonic_seconds();
    if (!write_head(history, layout)) {
        (void)fail(history);
        (void)snprintf(message, DAE_MESSAGE_LENGTH, "%s", history->message);
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
    return series_write(&history->times, is_last) && series_write(&history->events, is_last) &&
           netcdf_finish_dimension(netcdf, &history->wheel) && netcdf_finish_dimension(netcdf, &history->mesh) &&
           netcdf_finish_dimension(netcdf, &history->shaft) && netcdf_finish_dimension(netcdf, &history->axis) &&
           netcdf_finish_dimension(netcdf, &history->space) && netcdf_finish_dimension(netcdf, &history->quaternion) &&
           netcdf_finish_dimension(netcdf, &history->pair) && netcdf_finish_dimension(netcdf, &history->side);
}

/** From time to time, so that most of a killed run can be read. */
static bool flush_if_due(history *history)
{
    const time_t now = monotonic_seconds();
    if (now - history->last_flush < FLUSH_SECONDS) {
        return true;
    }
    history->last_flush = now;
    return write_all(history, false) && netcdf_flush(&history->netcdf);
}

static bool write_static(history *history, const model_output *output, const double *values)
{
    const netcdf_variable variable = describe_output(history, output);
    const hid_t dataset = netcdf_define(&history->netcdf, history->netcdf.id, &variable, 0);
    if (dataset < 0) {
        return false;
    }
    /* HDF5 turns whole doubles into integers. */
    const herr_t written = H5Dwrite(dataset, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, history->netcdf.transfer, values);
    return written < 0 || H5Dclose(dataset) < 0 ? netcdf_fail(&history->netcdf) : true;
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

bool history_put_finals(history *history, int n, const model_output *outputs, const double *values)
{
    bool good = true;
    for (int i = 0; i < n && good; i++) {
        good = write_static(history, &outputs[i], values + outputs[i].offset);
    }
    return good ? true : fail(history);
}

bool history_append(history *history, double t, const double *values)
{
    history->row[0] = t;
    memcpy(history->row + 1, values, (size_t)history->n_values * sizeof *values);
    const bool good = (history->n_rows > 0 || write_statics(history, values)) &&
                      series_append(&history->times, history->row) && flush_if_due(history);
    history->n_rows++;
    return good ? true : fail(history);
}

bool history_add_event(history *history, const event_record *record)
{
    double *row = history->event_row;
    row[EVENT_NUMBER] = (double)history->n_events;
    row[EVENT_TIME] = record->t;
    row[EVENT_KIND] = record->what.kind;
    row[EVENT_MESH] = record->what.subject;
    row[EVENT_FLANK] = record->what.side;
    row[EVENT_TOOTH_PAIR] = record->what.count;
    for (int i = 0; i < history->n_states; i++) {
        row[EVENT_STATES + 2 * i] = record->before->y[i];
        row[EVENT_STATES + 2 * i + 1] = record->after->y[i];
    }
    history->n_events++;
    return series_append(&history->events, row) && flush_if_due(history) ? true : fail(history);
}

bool history_close(history **pointer, bool commit, int n_attributes, const history_attribute *attributes,
                   char message[DAE_MESSAGE_LENGTH])
{
    history *history = *pointer;
    *pointer = NULL;
    bool good = write_all(history, true) && put_attributes(history, n_attributes, attributes) &&
                netcdf_flush(&history->netcdf) && netcdf_close(&history->netcdf);
    if (good) {
        good = output_file_close(&history->file, commit, message, DAE_MESSAGE_LENGTH);
    } else {
        (void)fail(history);
        (void)snprintf(message, DAE_MESSAGE_LENGTH, "%s", history->message);
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

const char *history_error(const history *history)
{
    return history->message;
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
