/* docs/result_format.md describes what this file writes. */
#include "files/response.h"

#include "base/memory.h"
#include "files/dimensions_in_file_hdf5.h"
#include "files/netcdf_common_hdf5.h"
#include "files/output_file.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { FORMAT = 1 };

typedef struct {
    netcdf_file netcdf;
    const response *from;
    int n_directions;
    int of[RESPONSE_DIRECTIONS]; /**< which they are */
    netcdf_dimension direction, parameter, jump;
    dimensions of_outputs;
} writer;

/* ---- what is told at each value ---- */

typedef double teller(const response_point *point);

static double tell_period(const response_point *point)
{
    return point->period;
}

static double tell_periods(const response_point *point)
{
    return point->periods;
}

static double tell_pitches(const response_point *point)
{
    return point->pitches;
}

static double tell_distance(const response_point *point)
{
    return point->period < 0 ? NAN : point->distance;
}

/** The first dimensions of all variables. */
static void put_axes(writer *w, netcdf_variable *variable)
{
    variable->dimensions[0] = &w->direction;
    variable->dimensions[1] = &w->parameter;
    variable->rank = 2;
}

static bool write_told(writer *w, const netcdf_variable *like, teller *tell)
{
    netcdf_variable variable = *like;
    const int n = w->from->n;
    OWNED double *values = xcalloc((size_t)w->n_directions * (size_t)n, sizeof *values);
    for (int d = 0; d < w->n_directions; d++) {
        for (int i = 0; i < n; i++) {
            values[d * n + i] = tell(&w->from->points[w->of[d]][i]);
        }
    }
    put_axes(w, &variable);
    CLOSED const hid_t dataset = netcdf_define(&w->netcdf, w->netcdf.id, &variable, 0);
    return dataset >= 0 && netcdf_write(&w->netcdf, dataset, H5T_NATIVE_DOUBLE, values);
}

static bool write_all_told(writer *w)
{
    static const struct {
        const char *name, *symbol, *text;
        netcdf_type type;
        teller *tell;
    } rows[] = {
        {"period", "p", "common periods after which the motion repeats; 0: it does not within 16; -1: not looked at",
         NETCDF_INTEGER, tell_period},
        {"followed", "", "common periods that the motion was followed", NETCDF_INTEGER, tell_periods},
        {"common_period", "N", "pitches of the first mesh in a common period", NETCDF_INTEGER, tell_pitches},
        {"repeat_distance", "", "largest difference of a state to that of one orbit before, in its unit", NETCDF_REAL,
         tell_distance},
    };
    bool good = true;
    for (size_t i = 0; i < sizeof rows / sizeof *rows && good; i++) {
        const netcdf_variable variable = netcdf_describe(rows[i].type, rows[i].name, "1", rows[i].symbol, rows[i].text);
        good = write_told(w, &variable, rows[i].tell);
    }
    return good;
}

/* ---- numbers ---- */

static bool write_number(writer *w, const model_output *output)
{
    netcdf_variable variable =
        netcdf_describe(NETCDF_REAL, output->name, output->units, output->symbol, output->long_name);
    const size_t count = (size_t)output->count, n = (size_t)w->from->n;
    OWNED double *values = xcalloc((size_t)w->n_directions * n * count, sizeof *values);
    double *to = values;
    for (int d = 0; d < w->n_directions; d++) {
        for (size_t i = 0; i < n; i++) {
            const response_point *point = &w->from->points[w->of[d]][i];
            for (size_t k = 0; k < count; k++) {
                *to++ = point->values == NULL ? NAN : point->values[(size_t)output->offset + k];
            }
        }
    }
    put_axes(w, &variable);
    dimensions_append(&w->of_outputs, output, &variable);
    CLOSED const hid_t dataset = netcdf_define(&w->netcdf, w->netcdf.id, &variable, 0);
    return dataset >= 0 && netcdf_write(&w->netcdf, dataset, H5T_NATIVE_DOUBLE, values);
}

/* ---- jumps ---- */

static double of_jump(const response_jump *jump, int what)
{
    const double all[] = {jump->direction, jump->before, jump->after, jump->period_before, jump->period_after};
    return all[what];
}

/** Which of the directions in the file. */
static int place_of(const writer *w, int direction)
{
    return w->of[0] == direction ? 0 : 1;
}

static bool write_jump_row(writer *w, netcdf_variable variable, int what)
{
    const int n = w->from->n_jumps;
    OWNED double *values = xcalloc((size_t)n + 1, sizeof *values);
    for (int i = 0; i < n; i++) {
        values[i] = what == 0 ? place_of(w, w->from->jumps[i].direction) : of_jump(&w->from->jumps[i], what);
    }
    variable.dimensions[0] = &w->jump;
    variable.rank = 1;
    CLOSED const hid_t dataset = netcdf_define(&w->netcdf, w->netcdf.id, &variable, 0);
    return dataset >= 0 && netcdf_write(&w->netcdf, dataset, H5T_NATIVE_DOUBLE, values);
}

static bool write_jump_deviation(writer *w, const model_output *like, const char *name, const char *text, bool is_after)
{
    netcdf_variable variable = netcdf_describe(NETCDF_REAL, name, "m", "", text);
    const int n = w->from->n_jumps, n_meshes = w->from->names->meshes.n;
    OWNED double *values = xcalloc((size_t)n * (size_t)n_meshes + 1, sizeof *values);
    for (int i = 0; i < n; i++) {
        const response_jump *jump = &w->from->jumps[i];
        for (int m = 0; m < n_meshes; m++) {
            values[i * n_meshes + m] = is_after ? jump->deviation_after[m] : jump->deviation_before[m];
        }
    }
    variable.dimensions[0] = &w->jump;
    variable.rank = 1;
    dimensions_append(&w->of_outputs, like, &variable);
    CLOSED const hid_t dataset = netcdf_define(&w->netcdf, w->netcdf.id, &variable, 0);
    return dataset >= 0 && netcdf_write(&w->netcdf, dataset, H5T_NATIVE_DOUBLE, values);
}

static bool write_jumps(writer *w)
{
    const char *units = w->from->units;
    const netcdf_variable rows[] = {
        netcdf_describe(NETCDF_INTEGER, "jump_direction", "1", "", "place of its direction in `direction`"),
        netcdf_describe(NETCDF_REAL, "jump_before", units, "", "last value of the parameter before it"),
        netcdf_describe(NETCDF_REAL, "jump_after", units, "", "first value of the parameter behind it"),
        netcdf_describe(NETCDF_INTEGER, "jump_period_before", "1", "", "period of the motion before it"),
        netcdf_describe(NETCDF_INTEGER, "jump_period_after", "1", "", "period of the motion behind it"),
    };
    static const model_output of_mesh = {.dims = "mesh"};
    OWNED double *numbers = xcalloc((size_t)w->from->n_jumps + 1, sizeof *numbers);
    for (int i = 0; i < w->from->n_jumps; i++) {
        numbers[i] = i;
    }
    const netcdf_variable jump =
        netcdf_describe(NETCDF_INTEGER, "jump", "1", "", "jumps in the order of their finding");
    bool good =
        netcdf_define_values(&w->netcdf, w->netcdf.id, &w->jump, &jump, w->from->n_jumps, H5T_NATIVE_DOUBLE, numbers);
    for (int i = 0; i < 5 && good; i++) {
        good = write_jump_row(w, rows[i], i);
    }
    return good &&
           write_jump_deviation(w, &of_mesh, "jump_deviation_before",
                                "standard deviation of the transmission error before it", false) &&
           write_jump_deviation(w, &of_mesh, "jump_deviation_after",
                                "standard deviation of the transmission error behind it", true);
}

/* ---- the file ---- */

static bool define_axes(writer *w)
{
    static const char *const words[] = {"up", "down"};
    const char *names[RESPONSE_DIRECTIONS];
    for (int d = 0; d < RESPONSE_DIRECTIONS; d++) {
        if (w->from->points[d] != NULL) {
            w->of[w->n_directions] = d;
            names[w->n_directions++] = words[d];
        }
    }
    const netcdf_variable direction =
        netcdf_describe(NETCDF_TEXT, "direction", "1", "direction",
                        "in which the parameter goes: up is from its first value to its last");
    const netcdf_variable parameter = netcdf_describe(
        NETCDF_REAL, "parameter", w->from->units[0] == '\0' ? "1" : w->from->units, "", w->from->parameter);
    dimensions_plan(&w->of_outputs, DIMENSIONS_OF_HISTORY, w->from->names, w->from->n_outputs, w->from->outputs);
    dimensions_plan_harmonics(&w->of_outputs, &w->netcdf.pool, w->from->n_harmonics);
    return netcdf_define_values(&w->netcdf, w->netcdf.id, &w->direction, &direction, w->n_directions, netcdf_kept.text,
                                names) &&
           netcdf_define_values(&w->netcdf, w->netcdf.id, &w->parameter, &parameter, w->from->n, H5T_NATIVE_DOUBLE,
                                w->from->values) &&
           dimensions_define(&w->of_outputs, &w->netcdf);
}

static bool put_attributes(writer *w)
{
    netcdf_file *netcdf = &w->netcdf;
    bool good = netcdf_put_text(netcdf, netcdf->id, "Conventions", "CF-1.10") &&
                netcdf_put_integer(netcdf, netcdf->id, "evolvent_format", FORMAT) &&
                netcdf_put_text(netcdf, netcdf->id, "evolvent_kind", "response");
    for (int i = 0; i < w->from->n_attributes && good; i++) {
        const history_attribute *a = &w->from->attributes[i];
        good = a->text != NULL ? netcdf_put_text(netcdf, netcdf->id, a->key, a->text)
                               : netcdf_put_integer(netcdf, netcdf->id, a->key, a->integer);
    }
    return good;
}

static bool fill(writer *w)
{
    bool good = put_attributes(w) && define_axes(w) && write_all_told(w);
    for (int i = 0; i < w->from->n_outputs && good; i++) {
        good = w->from->outputs[i].count == 0 || write_number(w, &w->from->outputs[i]);
    }
    return good && write_jumps(w) && scale_list_users(&w->netcdf, w->direction.scale) &&
           scale_list_users(&w->netcdf, w->parameter.scale) && scale_list_users(&w->netcdf, w->jump.scale) &&
           dimensions_finish(&w->of_outputs, &w->netcdf);
}

bool response_write(const response *response, bool commit, evl_error *error)
{
    output_file file;
    if (!output_file_open(&file, response->path, error)) {
        return false;
    }
    OWNED writer *w = xcalloc(1, sizeof *w);
    w->from = response;
    bool good = netcdf_create(&w->netcdf, file.partial_path) && fill(w);
    good = netcdf_close(&w->netcdf) && good;
    if (good) {
        return output_file_close(&file, commit, error);
    }
    output_file_refuse(file.partial_path, w->netcdf.system_error, w->netcdf.system_error != 0 ? NULL : w->netcdf.reason,
                       error);
    output_file_drop(&file, true);
    return false;
}
