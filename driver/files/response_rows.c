/* docs/guides/response.md describes this content. */
#include "files/response_rows.h"

#include "base/memory.h"
#include "files/history_body.h"

#include <math.h>

typedef struct {
    const response *from;
    response_axes *axes;
    const response_sink *sink;
    int n_directions;
    int of[RESPONSE_DIRECTIONS]; /**< their indices */
} writer;

/* ---- variables at each value ---- */

typedef double getter(const response_point *point);

static double get_period(const response_point *point)
{
    return point->period;
}

static double get_periods(const response_point *point)
{
    return point->periods;
}

static double get_pitches(const response_point *point)
{
    return point->pitches;
}

static double get_time_constant(const response_point *point)
{
    return point->period == -1 ? NAN : point->time_constant;
}

static double get_distance(const response_point *point)
{
    return point->period == -1 ? NAN : point->distance;
}

/** Add the first two dimensions of all variables. */
static void put_axes(writer *w, netcdf_variable *variable)
{
    variable->dimensions[0] = &w->axes->direction;
    variable->dimensions[1] = &w->axes->parameter;
    variable->rank = 2;
}

static bool write_point_variable(writer *w, const netcdf_variable *like, getter *get)
{
    netcdf_variable variable = *like;
    const int n = w->from->n;
    CLEANUP_FREE double *values = xcalloc((size_t)w->n_directions * (size_t)n, sizeof *values);
    for (int d = 0; d < w->n_directions; d++) {
        for (int i = 0; i < n; i++) {
            values[d * n + i] = get(&w->from->points[w->of[d]][i]);
        }
    }
    put_axes(w, &variable);
    return w->sink->variable(w->sink->self, &variable, values);
}

static bool write_point_variables(writer *w)
{
    static const struct {
        const char *name, *units, *symbol, *text;
        netcdf_type type;
        getter *get;
    } rows[] = {
        {"period", "1", "p",
         "common periods after which the motion repeats; 0: not within 16; -1: not determined; -2: still settling",
         NETCDF_INTEGER, get_period},
        {"followed", "1", "", "common periods for which the motion was integrated", NETCDF_INTEGER, get_periods},
        {"common_period", "1", "N", "pitches of the first mesh in a common period", NETCDF_INTEGER, get_pitches},
        {"repeat_distance", "1", "", "largest difference of a state to that of one orbit before, in its unit",
         NETCDF_REAL, get_distance},
        {"time_constant", "s", "", "time constant of the slowest damped mode at the mean mesh stiffness", NETCDF_REAL,
         get_time_constant},
    };
    bool good = true;
    for (size_t i = 0; i < sizeof rows / sizeof *rows && good; i++) {
        const netcdf_variable variable =
            netcdf_describe(rows[i].type, rows[i].name, rows[i].units, rows[i].symbol, rows[i].text);
        good = write_point_variable(w, &variable, rows[i].get);
    }
    return good;
}

/* ---- metrics ---- */

static bool write_number(writer *w, const model_output *output)
{
    netcdf_variable variable =
        netcdf_describe(NETCDF_REAL, output->name, output->units, output->symbol, output->long_name);
    const size_t count = (size_t)output->count, n = (size_t)w->from->n;
    CLEANUP_FREE double *values = xcalloc((size_t)w->n_directions * n * count, sizeof *values);
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
    dimensions_append(&w->axes->of_outputs, output, &variable);
    return w->sink->variable(w->sink->self, &variable, values);
}

/* ---- jumps ---- */

static double of_jump(const response_jump *jump, int what)
{
    const double all[] = {jump->direction, jump->before, jump->after, jump->period_before, jump->period_after};
    return all[what];
}

/** Index of a direction in the file. */
static int index_of(const writer *w, int direction)
{
    return w->of[0] == direction ? 0 : 1;
}

static bool write_jump_row(writer *w, netcdf_variable variable, int what)
{
    const int n = w->from->n_jumps;
    CLEANUP_FREE double *values = xcalloc((size_t)n + 1, sizeof *values);
    for (int i = 0; i < n; i++) {
        values[i] = what == 0 ? index_of(w, w->from->jumps[i].direction) : of_jump(&w->from->jumps[i], what);
    }
    variable.dimensions[0] = &w->axes->jump;
    variable.rank = 1;
    return w->sink->variable(w->sink->self, &variable, values);
}

static bool write_jump_deviation(writer *w, const model_output *like, const char *name, const char *text, bool is_after)
{
    netcdf_variable variable = netcdf_describe(NETCDF_REAL, name, "m", "", text);
    const int n = w->from->n_jumps, n_meshes = w->from->names->meshes.n;
    CLEANUP_FREE double *values = xcalloc((size_t)n * (size_t)n_meshes + 1, sizeof *values);
    for (int i = 0; i < n; i++) {
        const response_jump *jump = &w->from->jumps[i];
        for (int m = 0; m < n_meshes; m++) {
            values[i * n_meshes + m] = is_after ? jump->deviation_after[m] : jump->deviation_before[m];
        }
    }
    variable.dimensions[0] = &w->axes->jump;
    variable.rank = 1;
    dimensions_append(&w->axes->of_outputs, like, &variable);
    return w->sink->variable(w->sink->self, &variable, values);
}

static bool write_jumps(writer *w)
{
    const char *units = w->from->units;
    const netcdf_variable rows[] = {
        netcdf_describe(NETCDF_INTEGER, "jump_direction", "1", "", "index of its direction in `direction`"),
        netcdf_describe(NETCDF_REAL, "jump_before", units, "", "last value of the parameter before it"),
        netcdf_describe(NETCDF_REAL, "jump_after", units, "", "first value of the parameter after it"),
        netcdf_describe(NETCDF_INTEGER, "jump_period_before", "1", "", "period of the motion before it"),
        netcdf_describe(NETCDF_INTEGER, "jump_period_after", "1", "", "period of the motion after it"),
    };
    static const model_output of_mesh = {.dims = "mesh"};
    CLEANUP_FREE double *numbers = xcalloc((size_t)w->from->n_jumps + 1, sizeof *numbers);
    for (int i = 0; i < w->from->n_jumps; i++) {
        numbers[i] = i;
    }
    const netcdf_variable jump = netcdf_describe(NETCDF_INTEGER, "jump", "1", "", "jumps in the order found");
    bool good = w->sink->axis(w->sink->self, &w->axes->jump, &jump, w->from->n_jumps, numbers);
    for (int i = 0; i < 5 && good; i++) {
        good = write_jump_row(w, rows[i], i);
    }
    return good &&
           write_jump_deviation(w, &of_mesh, "jump_deviation_before",
                                "standard deviation of the transmission error before it", false) &&
           write_jump_deviation(w, &of_mesh, "jump_deviation_after",
                                "standard deviation of the transmission error after it", true);
}

/* ---- complete response ---- */

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
    const netcdf_variable direction = netcdf_describe(
        NETCDF_TEXT, "direction", "1", "direction", "direction of the parameter; up: from its first value to its last");
    const netcdf_variable parameter = netcdf_describe(
        NETCDF_REAL, "parameter", w->from->units[0] == '\0' ? "1" : w->from->units, "", w->from->parameter);
    dimensions *of_outputs = &w->axes->of_outputs;
    dimensions_plan(of_outputs, DIMENSIONS_OF_HISTORY, w->from->names, w->from->n_outputs, w->from->outputs);
    dimensions_plan_harmonics(of_outputs, w->axes->arena, w->from->n_harmonics);
    bool good = w->sink->axis(w->sink->self, &w->axes->direction, &direction, w->n_directions, names) &&
                w->sink->axis(w->sink->self, &w->axes->parameter, &parameter, w->from->n, w->from->values);
    for (int i = 0; i < N_DIMENSIONS && good; i++) {
        const dimension_values *values = &of_outputs->values[i];
        const bool is_text = values->variable.type == NETCDF_TEXT;
        good =
            !values->is_there || w->sink->axis(w->sink->self, &of_outputs->of[i], &values->variable, values->n,
                                               is_text ? (const void *)values->names : (const void *)values->numbers);
    }
    return good;
}

bool response_transfer(const response *response, response_axes *axes, const response_sink *sink)
{
    writer all = {.from = response, .axes = axes, .sink = sink}, *w = &all;
    history_attribute common[N_COMMON_ATTRIBUTES];
    history_common_attributes(&(history_layout){.kind = "response"}, common);
    bool good = true;
    for (int i = 0; i < N_COMMON_ATTRIBUTES && good; i++) {
        good = sink->attribute(sink->self, &common[i]);
    }
    for (int i = 0; i < response->n_attributes && good; i++) {
        good = sink->attribute(sink->self, &response->attributes[i]);
    }
    good = good && define_axes(w) && write_point_variables(w);
    for (int i = 0; i < response->n_outputs && good; i++) {
        good = response->outputs[i].count == 0 || write_number(w, &response->outputs[i]);
    }
    return good && write_jumps(w);
}
