#include "files/design.h"

#include "base/log.h"
#include "base/number.h"
#include "files/checksum.h"
#include "files/design_hash.h"
#include "files/netcdf_hdf5.h"

#include <errno.h>
#include <evolvent_version.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { FORMAT = 1 };

typedef struct {
    const char *path;
    hid_t file;
    evl_error *error;
} reader;

/** @return false */
static bool refuse(const reader *reader, const char *what, const char *message)
{
    return evl_error_set(reader->error, EVL_EXIT_CASE, reader->path, "%s%s%s", what, what[0] == '\0' ? "" : ": ",
                         message);
}

/* ---- attributes ---- */

static bool need_text(const reader *reader, const char *name, memory_arena *arena, char **text)
{
    *text = netcdf_get_text(reader->file, name, arena);
    return *text != NULL || refuse(reader, name, "this attribute of the design is missing, or not a text");
}

/** Check format and maker before anything else. */
static bool check_maker(const reader *reader)
{
    long long format = 0;
    if (!netcdf_get_numbers(reader->file, "evolvent_design_format", H5T_NATIVE_LLONG, 1, &format)) {
        return refuse(reader, "",
                      "is not a design (no attribute evolvent_design_format); create one with evolvent-sweep plan");
    }
    if (format != FORMAT) {
        return evl_error_set(reader->error, EVL_EXIT_CASE, reader->path,
                             "is a design of format %lld, but this evolvent reads format %d only; plan it again",
                             format, FORMAT);
    }
    CLEANUP_FREE char *version = NULL;
    return need_text(reader, "evolvent_version", NULL, &version) &&
           (strcmp(version, EVOLVENT_VERSION) == 0 ||
            evl_error_set(
                reader->error, EVL_EXIT_CASE, reader->path,
                "was made by evolvent %.32s, this is %s; plan it again, so that all results are of one version",
                version, EVOLVENT_VERSION));
}

/** Read the kind of the cases, if they are no runs; may be missing. */
static bool read_respond(const reader *reader, design *design)
{
    long long periods = 0;
    char *over = netcdf_get_text(reader->file, "respond_over", &design->arena);
    char *direction = netcdf_get_text(reader->file, "respond_direction", &design->arena);
    design->respond_over = over == NULL ? arena_copy(&design->arena, "") : over;
    design->respond_direction = direction == NULL ? arena_copy(&design->arena, "both") : direction;
    if (H5Aexists(reader->file, "respond_periods") > 0 &&
        (!netcdf_get_numbers(reader->file, "respond_periods", H5T_NATIVE_LLONG, 1, &periods) || periods < 0 ||
         periods > 1000000)) {
        return refuse(reader, "respond_periods", "this attribute of the design is not a number of common periods");
    }
    design->respond_periods = (long)periods;
    return true;
}

static bool read_head(const reader *reader, design *design)
{
    long long n_cases = 0, every = 1, rows = 0;
    if (!check_maker(reader) || !need_text(reader, "case", &design->arena, &design->base_case) ||
        !need_text(reader, "history_variables", &design->arena, &design->history_variables)) {
        return false;
    }
    char *metrics = netcdf_get_text(reader->file, "numbers", &design->arena); /* may be missing */
    design->metrics = metrics == NULL ? arena_copy(&design->arena, "") : metrics;
    if (!netcdf_get_numbers(reader->file, "n_cases", H5T_NATIVE_LLONG, 1, &n_cases) || n_cases < 0) {
        return refuse(reader, "n_cases", "this attribute of the design is missing, or not a count");
    }
    if (n_cases == 0) {
        return refuse(reader, "", "is an empty design without cases");
    }
    if (!netcdf_get_numbers(reader->file, "window", H5T_NATIVE_DOUBLE, 2, design->window)) {
        return refuse(reader, "window", "this attribute of the design is missing, or not two times [s]");
    }
    if (design->window[0] > design->window[1] || design->window[1] < 0) {
        return evl_error_set(reader->error, EVL_EXIT_CASE, reader->path,
                             "window: from %g to %g s is not a time span of a case", design->window[0],
                             design->window[1]);
    }
    if (!netcdf_get_numbers(reader->file, "history_every", H5T_NATIVE_LLONG, 1, &every) || every < 1 ||
        every > 1000000000) {
        return refuse(reader, "history_every", "this attribute of the design is missing, or less than 1");
    }
    if (H5Aexists(reader->file, "history_rows") > 0 &&
        (!netcdf_get_numbers(reader->file, "history_rows", H5T_NATIVE_LLONG, 1, &rows) || rows < 0 ||
         rows > 1000000000)) {
        return refuse(reader, "history_rows", "this attribute of the design is not a count");
    }
    if (!read_respond(reader, design)) {
        return false;
    }
    design->n_cases = (long)n_cases;
    design->history_every = (long)every;
    design->history_rows = (long)rows;
    return true;
}

/* ---- columns ---- */

static bool read_values(const reader *reader, hid_t dataset, const char *name, design *design, design_column *column)
{
    _Static_assert(sizeof(design_value) == sizeof(double), "values stand side by side");
    CLOSED const hid_t type = H5Dget_type(dataset), text = H5Tcopy(H5T_C_S1);
    const H5T_class_t class = H5Tget_class(type);
    const bool is_real = class == H5T_FLOAT, is_integer = class == H5T_INTEGER;
    const hid_t in_memory = is_real ? H5T_NATIVE_DOUBLE : is_integer ? H5T_NATIVE_LLONG : text;
    column->type = is_real ? DESIGN_REAL : is_integer ? DESIGN_INTEGER : DESIGN_TEXT;
    column->values = arena_calloc(&design->arena, (size_t)design->n_cases, sizeof *column->values);
    const bool is_known = is_real || is_integer || (class == H5T_STRING && H5Tis_variable_str(type) > 0);
    (void)(H5Tset_size(text, H5T_VARIABLE) >= 0 && H5Tset_cset(text, H5T_CSET_UTF8));
    return (is_known && H5Dread(dataset, in_memory, H5S_ALL, H5S_ALL, H5P_DEFAULT, column->values) >= 0) ||
           refuse(reader, name, "cannot be read; a column holds floats, integers, or texts of variable length");
}

/** Read the column of a dataset, if it has a path. */
static bool read_column(const reader *reader, hid_t parameters, const char *name, design *design)
{
    CLOSED const hid_t dataset = H5Dopen2(parameters, name, H5P_DEFAULT);
    if (dataset < 0) {
        return refuse(reader, name, "this column is missing; columns are parameters/p0, p1, ...");
    }
    CLOSED const hid_t space = H5Dget_space(dataset);
    if (H5Sget_simple_extent_ndims(space) != 1 || H5Sget_simple_extent_npoints(space) != design->n_cases) {
        return evl_error_set(reader->error, EVL_EXIT_CASE, reader->path,
                             "%s: does not have one value for each of the %ld cases", name, design->n_cases);
    }
    char *path = netcdf_get_text(dataset, "path", &design->arena);
    if (path == NULL) {
        return refuse(reader, name, "has no attribute path");
    }
    if (path[0] == '\0') { /* a derived quantity: cases do not depend on it */
        return true;
    }
    design_column *column = &design->columns[design->n_columns++];
    *column = (design_column){.path = path};
    return read_values(reader, dataset, name, design, column);
}

static bool read_columns(const reader *reader, design *design)
{
    H5G_info_t info = {0};
    const bool is_there = H5Lexists(reader->file, "parameters", H5P_DEFAULT) > 0;
    CLOSED const hid_t parameters = is_there ? H5Gopen2(reader->file, "parameters", H5P_DEFAULT) : -1;
    if (parameters < 0 || H5Gget_info(parameters, &info) < 0) {
        return refuse(reader, "", "has no group parameters");
    }
    design->columns = arena_calloc(&design->arena, (size_t)info.nlinks, sizeof *design->columns);
    bool good = true;
    for (hsize_t i = 0; i < info.nlinks && good; i++) {
        char name[32];
        (void)snprintf(name, sizeof name, "p%llu", (unsigned long long)i);
        good = read_column(reader, parameters, name, design);
    }
    return good;
}

/* ---- the file ---- */

/** To be called before the library opens the file, since it does not detect damage. */
static bool verify_checksum(const reader *reader)
{
    switch (checksum_verify(reader->path)) {
    case CHECKSUM_CORRECT:
        return true;
    case CHECKSUM_NONE:
        log_warning("%s: has no checksum, so damage would not be detected; plan it again with evolvent-sweep plan",
                    reader->path);
        return true;
    case CHECKSUM_WRONG:
        return refuse(reader, "",
                      "is damaged, or was changed: its checksum is wrong; use an intact copy, or plan it again");
    case CHECKSUM_UNREADABLE:
        break;
    }
    return evl_error_set(reader->error, EVL_EXIT_CASE, reader->path, "cannot be read: %s", strerror(errno));
}

/** Compute the hash that identifies results, and compare it with the one stored by evolvent-sweep. */
static bool find_hash(const reader *reader, design *design)
{
    char *plan = netcdf_get_text(reader->file, "plan", &design->arena);
    char *given = netcdf_get_text(reader->file, "hash", &design->arena);
    const bool is_ours = plan != NULL && plan[0] != '\0';
    design->hash = arena_calloc(&design->arena, SHA256_TEXT, 1);
    design_hash(design, is_ours || given == NULL ? "" : given, design->hash);
    return !is_ours || (given != NULL && strcmp(given, design->hash) == 0) ||
           refuse(reader, "", "its values do not match its hash, so it was changed; plan it again");
}

design *design_read(const char *path, evl_error *error)
{
    memset(error, 0, sizeof *error);
    if (access(path, R_OK) != 0) {
        (void)evl_error_set(error, EVL_EXIT_CASE, path, "cannot be read: %s", strerror(errno));
        return NULL;
    }
    reader reader = {.path = path, .error = error};
    if (!verify_checksum(&reader)) {
        return NULL;
    }
    CLOSED const hid_t file = netcdf_open(path);
    reader.file = file;
    design *design = xcalloc(1, sizeof *design);
    design->file = arena_copy(&design->arena, path);
    const bool is_open =
        file >= 0 ||
        refuse(&reader, "", netcdf_system_reason("is not an HDF5 file; create a design with evolvent-sweep plan"));
    if (!is_open || !read_head(&reader, design) || !read_columns(&reader, design) || !find_hash(&reader, design)) {
        design_delete(&design);
    }
    return design;
}

void design_delete(design **pointer)
{
    design *design = *pointer;
    *pointer = NULL;
    if (design == NULL) {
        return;
    }
    for (int i = 0; i < design->n_columns; i++) {
        const design_column *column = &design->columns[i];
        for (long k = 0; k < design->n_cases && column->type == DESIGN_TEXT && column->values != NULL; k++) {
            (void)H5free_memory(column->values[k].text);
        }
    }
    arena_free(&design->arena);
    free(design);
}

char *design_option(const design *design, int column, long index, memory_arena *arena)
{
    const design_column *from = &design->columns[column];
    const design_value *value = &from->values[index];
    char text[NUMBER_TEXT_LENGTH] = ".nan";
    if (from->type == DESIGN_TEXT) {
        return arena_printf(arena, "%s=%s", from->path, value->text == NULL ? "" : value->text);
    }
    if (from->type == DESIGN_INTEGER) {
        (void)snprintf(text, sizeof text, "%lld", value->integer);
    } else if (isinf(value->real)) {
        (void)snprintf(text, sizeof text, value->real > 0 ? ".inf" : "-.inf");
    } else if (!isnan(value->real)) {
        number_write(text, value->real);
    }
    return arena_printf(arena, "%s=%s", from->path, text);
}
