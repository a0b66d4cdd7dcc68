/* docs/guides/response.md describes the output of this file. */
#include "files/orbits.h"

#include "base/memory.h"
#include "files/dimensions_in_file_hdf5.h"
#include "files/netcdf_common_hdf5.h"
#include "files/output_file.h"

#include <math.h>
#include <stdio.h>

enum { FORMAT = 1 };

typedef struct {
    netcdf_file netcdf;
    const orbit_branches *from;
    int n_multipliers;
    netcdf_dimension branch, point, multiplier;
    dimensions of_outputs;
} writer;

/* ---- variables of each point ---- */

typedef double getter(const orbit_point *point);

static double get_parameter(const orbit_point *point)
{
    return point->orbit.parameter;
}

static double get_branch(const orbit_point *point)
{
    return point->branch;
}

static double get_period(const orbit_point *point)
{
    return point->orbit.periods;
}

static double get_time(const orbit_point *point)
{
    return point->orbit.time;
}

/** At a grazing point multipliers differ between its sides, and may grow without bound on one of them. */
static bool is_grazing(const orbit_point *point)
{
    return point->orbit.kind == MODEL_ORBIT_GRAZING || point->orbit.kind == MODEL_ORBIT_GRAZING_FOLD;
}

static double get_grazing(const orbit_point *point)
{
    enum { NONE, TOOTH_PAIR, MESH };
    return !is_grazing(point) ? NONE : point->orbit.whole_mesh ? MESH : TOOTH_PAIR;
}

static double get_multipliers(const orbit_point *point)
{
    enum { COMPUTED, NOT_COMPUTED, UNDEFINED };
    return is_grazing(point) ? UNDEFINED : point->orbit.n_multipliers > 0 ? COMPUTED : NOT_COMPUTED;
}

static double get_stable(const orbit_point *point)
{
    return is_grazing(point) ? -1 : point->orbit.is_stable;
}

static double get_kind(const orbit_point *point)
{
    return point->orbit.kind;
}

static double get_mesh(const orbit_point *point)
{
    return point->orbit.mesh;
}

static double get_value(const orbit_point *point)
{
    return point->at_value;
}

static double get_residual(const orbit_point *point)
{
    return point->orbit.residual;
}

static bool write_real(writer *w, netcdf_variable variable, netcdf_dimension *first, const double *values)
{
    variable.dimensions[0] = first;
    variable.rank = 1;
    CLOSED const hid_t dataset = netcdf_define(&w->netcdf, w->netcdf.id, &variable, 0);
    return dataset >= 0 && netcdf_write(&w->netcdf, dataset, H5T_NATIVE_DOUBLE, values);
}

static bool write_point_variables(writer *w)
{
    const char *units = w->from->units[0] == '\0' ? "1" : w->from->units;
    static const char kinds[] = "ordinary fold crossing doubling neimark_sacker touch touch_fold";
    static const char grazings[] = "none tooth_pair mesh", multipliers[] = "computed not_computed undefined";
    const struct {
        netcdf_variable variable;
        getter *get;
    } rows[] = {
        {netcdf_describe(NETCDF_REAL, "orbit_parameter", units, "", w->from->parameter), get_parameter},
        {netcdf_describe(NETCDF_INTEGER, "orbit_branch", "1", "", "index of its branch in `branch`"), get_branch},
        {netcdf_describe(NETCDF_INTEGER, "orbit_period", "1", "p", "common periods after which the orbit repeats"),
         get_period},
        {netcdf_describe(NETCDF_REAL, "orbit_time", "s", "T", "time after which the orbit repeats"), get_time},
        {netcdf_describe(
             NETCDF_INTEGER, "orbit_stable", "1", "",
             "1: all multipliers are smaller than 1, or those of both neighbours; 0: not; -1: undefined at a grazing"),
         get_stable},
        {{.type = NETCDF_INTEGER,
          .name = "orbit_kind",
          .units = "1",
          .symbol = "",
          .long_name = "type of this point of the branch",
          .n_flags = MODEL_ORBIT_GRAZING_FOLD + 1,
          .flag_meanings = kinds},
         get_kind},
        {{.type = NETCDF_INTEGER,
          .name = "orbit_grazing",
          .units = "1",
          .symbol = "",
          .long_name = "grazing contact: one tooth pair while others of its mesh carry load, or the whole mesh",
          .n_flags = 3,
          .flag_meanings = grazings},
         get_grazing},
        {{.type = NETCDF_INTEGER,
          .name = "multiplier_status",
          .units = "1",
          .symbol = "",
          .long_name = "whether there are multipliers; at a grazing they differ on both sides and are omitted",
          .n_flags = 3,
          .flag_meanings = multipliers},
         get_multipliers},
        {netcdf_describe(NETCDF_INTEGER, "orbit_touch_mesh", "1", "",
                         "index in `mesh` of the grazing flanks; -1: none"),
         get_mesh},
        {netcdf_describe(NETCDF_INTEGER, "orbit_value", "1", "",
                         "index of its value among those of --values, from 0; -1: none"),
         get_value},
        {netcdf_describe(NETCDF_REAL, "orbit_residual", "1", "",
                         "largest difference after a period, in units of the states"),
         get_residual},
    };
    CLEANUP_FREE double *values = xcalloc((size_t)w->from->n_points + 1, sizeof *values);
    bool good = true;
    for (size_t i = 0; i < sizeof rows / sizeof *rows && good; i++) {
        for (int k = 0; k < w->from->n_points; k++) {
            values[k] = rows[i].get(&w->from->points[k]);
        }
        good = write_real(w, rows[i].variable, &w->point, values);
    }
    return good;
}

static bool write_multipliers(writer *w, const char *name, const char *text, int part)
{
    netcdf_variable variable = netcdf_describe(NETCDF_REAL, name, "1", "mu", text);
    const int n = w->from->n_points, m = w->n_multipliers;
    CLEANUP_FREE double *values = xcalloc((size_t)n * (size_t)m + 1, sizeof *values);
    for (int k = 0; k < n; k++) {
        const orbit_point *point = &w->from->points[k];
        for (int i = 0; i < m; i++) {
            values[k * m + i] =
                i < point->orbit.n_multipliers && !is_grazing(point) ? point->multipliers[2 * i + part] : NAN;
        }
    }
    variable.dimensions[0] = &w->point;
    variable.dimensions[1] = &w->multiplier;
    variable.rank = 2;
    CLOSED const hid_t dataset = netcdf_define(&w->netcdf, w->netcdf.id, &variable, 0);
    return dataset >= 0 && netcdf_write(&w->netcdf, dataset, H5T_NATIVE_DOUBLE, values);
}

static bool write_grazing(writer *w)
{
    netcdf_variable variable =
        netcdf_describe(NETCDF_TEXT, "orbit_touch", "1", "", "grazing contact there; empty: none");
    const int n = w->from->n_points;
    CLEANUP_FREE const char **texts = xcalloc((size_t)n + 1, sizeof *texts);
    for (int k = 0; k < n; k++) {
        texts[k] = w->from->points[k].orbit.root;
    }
    variable.dimensions[0] = &w->point;
    variable.rank = 1;
    CLOSED const hid_t dataset = netcdf_define(&w->netcdf, w->netcdf.id, &variable, 0);
    return dataset >= 0 && netcdf_write(&w->netcdf, dataset, netcdf_cached.text, texts);
}

static bool write_branches(writer *w)
{
    const int n = w->from->n_branches;
    CLEANUP_FREE double *parents = xcalloc((size_t)n + 1, sizeof *parents);
    CLEANUP_FREE const char **ends = xcalloc((size_t)n + 1, sizeof *ends);
    for (int i = 0; i < n; i++) {
        parents[i] = w->from->branches[i].parent;
        ends[i] = w->from->branches[i].end;
    }
    netcdf_variable end = netcdf_describe(NETCDF_TEXT, "branch_end", "1", "",
                                          "reason of its end; empty: the end of the range, or it is closed");
    end.dimensions[0] = &w->branch;
    end.rank = 1;
    CLOSED const hid_t dataset = netcdf_define(&w->netcdf, w->netcdf.id, &end, 0);
    return dataset >= 0 && netcdf_write(&w->netcdf, dataset, netcdf_cached.text, ends) &&
           write_real(w,
                      netcdf_describe(NETCDF_INTEGER, "branch_parent", "1", "",
                                      "index of the branch at whose period doubling it starts; -1: none"),
                      &w->branch, parents);
}

/* ---- metrics ---- */

static bool write_number(writer *w, const model_output *output)
{
    netcdf_variable variable =
        netcdf_describe(NETCDF_REAL, output->name, output->units, output->symbol, output->long_name);
    const size_t count = (size_t)output->count, n = (size_t)w->from->n_points;
    CLEANUP_FREE double *values = xcalloc(n * count + 1, sizeof *values);
    for (size_t i = 0; i < n; i++) {
        const orbit_point *point = &w->from->points[i];
        for (size_t k = 0; k < count; k++) {
            values[i * count + k] = point->values == NULL ? NAN : point->values[(size_t)output->offset + k];
        }
    }
    variable.dimensions[0] = &w->point;
    variable.rank = 1;
    dimensions_append(&w->of_outputs, output, &variable);
    CLOSED const hid_t dataset = netcdf_define(&w->netcdf, w->netcdf.id, &variable, 0);
    return dataset >= 0 && netcdf_write(&w->netcdf, dataset, H5T_NATIVE_DOUBLE, values);
}

/* ---- the file ---- */

/** A dimension whose coordinate counts from 0. */
static bool define_count(writer *w, netcdf_dimension *dimension, const char *name, const char *text, int n)
{
    const netcdf_variable variable = netcdf_describe(NETCDF_INTEGER, name, "1", "", text);
    CLEANUP_FREE double *numbers = xcalloc((size_t)n + 1, sizeof *numbers);
    for (int i = 0; i < n; i++) {
        numbers[i] = i;
    }
    return netcdf_define_values(&w->netcdf, w->netcdf.id, dimension, &variable, n, H5T_NATIVE_DOUBLE, numbers);
}

static bool define_axes(writer *w)
{
    for (int k = 0; k < w->from->n_points; k++) {
        const int n = w->from->points[k].orbit.n_multipliers;
        w->n_multipliers = n > w->n_multipliers ? n : w->n_multipliers;
    }
    dimensions_plan(&w->of_outputs, DIMENSIONS_OF_HISTORY, w->from->names, w->from->n_outputs, w->from->outputs);
    dimensions_plan_harmonics(&w->of_outputs, &w->netcdf.arena, w->from->n_harmonics);
    return define_count(w, &w->branch, "branch", "branches in the order found", w->from->n_branches) &&
           define_count(w, &w->point, "point", "points of all branches, in the order along each", w->from->n_points) &&
           define_count(w, &w->multiplier, "multiplier", "in the order of decreasing magnitude", w->n_multipliers) &&
           dimensions_define(&w->of_outputs, &w->netcdf);
}

static bool put_attributes(writer *w)
{
    netcdf_file *netcdf = &w->netcdf;
    bool good = netcdf_put_text(netcdf, netcdf->id, "Conventions", "CF-1.10") &&
                netcdf_put_integer(netcdf, netcdf->id, "evolvent_format", FORMAT) &&
                netcdf_put_text(netcdf, netcdf->id, "evolvent_kind", "orbits");
    for (int i = 0; i < w->from->n_attributes && good; i++) {
        const history_attribute *a = &w->from->attributes[i];
        good = a->text != NULL ? netcdf_put_text(netcdf, netcdf->id, a->key, a->text)
                               : netcdf_put_integer(netcdf, netcdf->id, a->key, a->integer);
    }
    return good;
}

static bool fill(writer *w)
{
    bool good = put_attributes(w) && define_axes(w) && write_branches(w) && write_point_variables(w) &&
                write_grazing(w) && write_multipliers(w, "multiplier_real", "Floquet multiplier, real part", 0) &&
                write_multipliers(w, "multiplier_imaginary", "Floquet multiplier, imaginary part", 1);
    for (int i = 0; i < w->from->n_outputs && good; i++) {
        good = w->from->outputs[i].count == 0 || write_number(w, &w->from->outputs[i]);
    }
    return good && scale_list_users(&w->netcdf, w->branch.scale) && scale_list_users(&w->netcdf, w->point.scale) &&
           scale_list_users(&w->netcdf, w->multiplier.scale) && dimensions_finish(&w->of_outputs, &w->netcdf);
}

bool orbits_write(const orbit_branches *orbits, bool commit, evl_error *error)
{
    output_file file;
    if (!output_file_open(&file, orbits->path, error)) {
        return false;
    }
    CLEANUP_FREE writer *w = xcalloc(1, sizeof *w);
    w->from = orbits;
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
