#include "files/netcdf_hdf5.h"
#include "files/output_file.h"
#include "files/parts.h"

#include "base/memory.h"

#include <stdlib.h>
#include <string.h>

enum { BLOCK_BYTES = 4 * 1024 * 1024, EVENT_NUMBERS = 5 };

/** Columns of a table that grows, and some rows of them. */
typedef struct {
    hid_t place;     /**< file or group */
    hsize_t rows;    /**< that it has */
    size_t n_values; /**< of a row */
    size_t n_block;  /**< rows that there is room for */
    double *block;   /**< [n_block * n_values] */
    double *column;  /**< [n_block * n_values] of one variable */
} table;

static hsize_t rows_of(hid_t place, const char *name)
{
    CLOSED const hid_t dataset = H5Lexists(place, name, H5P_DEFAULT) > 0 ? H5Dopen2(place, name, H5P_DEFAULT) : -1;
    CLOSED const hid_t space = dataset < 0 ? dataset : H5Dget_space(dataset);
    hsize_t extent[NETCDF_MAX_RANK] = {0};
    const int rank = space < 0 ? 0 : H5Sget_simple_extent_ndims(space);
    return rank > 0 && rank <= NETCDF_MAX_RANK && H5Sget_simple_extent_dims(space, extent, NULL) == rank ? extent[0]
                                                                                                         : 0;
}

static table table_of(memory_pool *pool, hid_t place, size_t n_values)
{
    table made = {.place = place, .rows = rows_of(place, "time"), .n_values = n_values};
    const size_t most = 1 + BLOCK_BYTES / (n_values * sizeof(double));
    made.n_block = made.rows < most ? (size_t)made.rows : most;
    made.block = pool_calloc(pool, made.n_block * n_values + 1, sizeof(double));
    made.column = pool_calloc(pool, made.n_block * n_values + 1, sizeof(double));
    return made;
}

/** Read `n` rows of a variable with `count` numbers a row into the block, at an offset of its rows. */
static bool read_column(const table *table, const char *name, hsize_t first, size_t n, size_t count, size_t offset)
{
    CLOSED const hid_t dataset = H5Dopen2(table->place, name, H5P_DEFAULT);
    CLOSED const hid_t space = dataset < 0 ? dataset : H5Dget_space(dataset);
    hsize_t extent[NETCDF_MAX_RANK], start[NETCDF_MAX_RANK] = {first};
    const int rank = space < 0 ? 0 : H5Sget_simple_extent_ndims(space);
    if (rank < 1 || rank > NETCDF_MAX_RANK || H5Sget_simple_extent_dims(space, extent, NULL) != rank ||
        extent[0] < first + n) {
        return false;
    }
    size_t of_row = 1;
    for (int i = 1; i < rank; i++) {
        of_row *= (size_t)extent[i];
    }
    extent[0] = n;
    CLOSED const hid_t memory =
        H5Screate_simple(rank, extent, NULL); /* of another shape it would go number by number */
    if (of_row != count || memory < 0 || H5Sselect_hyperslab(space, H5S_SELECT_SET, start, NULL, extent, NULL) < 0 ||
        H5Dread(dataset, H5T_NATIVE_DOUBLE, memory, space, H5P_DEFAULT, table->column) < 0) {
        return false;
    }
    for (size_t k = 0; k < n; k++) {
        memcpy(table->block + k * table->n_values + offset, table->column + k * count, count * sizeof(double));
    }
    return true;
}

/** What never changes, into all rows of the block: it is asked for with the first one. */
static bool read_static(const table *table, const char *name, size_t n, size_t count, size_t offset)
{
    CLOSED const hid_t dataset = H5Dopen2(table->place, name, H5P_DEFAULT);
    CLOSED const hid_t space = dataset < 0 ? dataset : H5Dget_space(dataset);
    if (space < 0 || H5Sget_simple_extent_npoints(space) != (hssize_t)count ||
        count > table->n_block * table->n_values ||
        H5Dread(dataset, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, table->column) < 0) {
        return false;
    }
    for (size_t k = 0; k < n; k++) {
        memcpy(table->block + k * table->n_values + offset, table->column, count * sizeof(double));
    }
    return true;
}

/** Rows: time, then the outputs. */
static bool append_rows(memory_pool *pool, hid_t file, const history_layout *layout, history *to, bool *is_readable,
                        evl_error *error)
{
    size_t n_values = 1;
    for (int i = 0; i < layout->n_outputs; i++) {
        const size_t end = 1 + (size_t)(layout->outputs[i].offset + layout->outputs[i].count);
        n_values = end > n_values ? end : n_values;
    }
    const table rows = table_of(pool, file, n_values);
    for (hsize_t first = 0; first < rows.rows; first += rows.n_block) {
        const size_t n = rows.rows - first < rows.n_block ? (size_t)(rows.rows - first) : rows.n_block;
        bool good = read_column(&rows, "time", first, n, 1, 0);
        for (int i = 0; i < layout->n_outputs && good; i++) {
            const model_output *output = &layout->outputs[i];
            const size_t count = (size_t)output->count, offset = 1 + (size_t)output->offset;
            good = count == 0          ? true
                   : output->is_static ? read_static(&rows, output->name, n, count, offset)
                                       : read_column(&rows, output->name, first, n, count, offset);
        }
        *is_readable = good;
        for (size_t k = 0; k < n && good; k++) {
            const double *row = rows.block + k * n_values;
            good = history_append(to, row[0], row + 1, error);
        }
        if (!good) {
            return false;
        }
    }
    return true;
}

/** Events: five numbers, then both sides of each state. */
static bool append_events(memory_pool *pool, hid_t file, const history_layout *layout, history *to, bool *is_readable,
                          evl_error *error)
{
    static const char *const numbers[EVENT_NUMBERS] = {"time", "kind", "mesh", "flank", "tooth_pair"};
    const size_t n_states = (size_t)layout->n_states, n_values = EVENT_NUMBERS + 2 * n_states;
    CLOSED const hid_t group = H5Gopen2(file, "events", H5P_DEFAULT);
    *is_readable = group >= 0;
    if (group < 0) {
        return false;
    }
    const table rows = table_of(pool, group, n_values);
    double *before = pool_calloc(pool, n_states, sizeof *before), *after = pool_calloc(pool, n_states, sizeof *after);
    for (hsize_t first = 0; first < rows.rows; first += rows.n_block) {
        const size_t n = rows.rows - first < rows.n_block ? (size_t)(rows.rows - first) : rows.n_block;
        bool good = true;
        for (size_t i = 0; i < EVENT_NUMBERS && good; i++) {
            good = read_column(&rows, numbers[i], first, n, 1, i);
        }
        for (size_t i = 0; i < n_states && good; i++) {
            good = read_column(&rows, layout->states[i].name, first, n, 2, EVENT_NUMBERS + 2 * i);
        }
        *is_readable = good;
        for (size_t k = 0; k < n && good; k++) {
            const double *row = rows.block + k * n_values, *states = row + EVENT_NUMBERS;
            for (size_t i = 0; i < n_states; i++) {
                before[i] = states[2 * i];
                after[i] = states[2 * i + 1];
            }
            const history_event event = {row[0], (int)row[1], (int)row[2], (int)row[3], (int)row[4], before, after};
            good = history_add_event(to, &event, error);
        }
        if (!good) {
            return false;
        }
    }
    return true;
}

bool part_append(const char *path, const history_layout *layout, history *to, evl_error *error)
{
    POOLED memory_pool pool = {NULL};
    bool is_readable = true;
    const hid_t file = netcdf_open(path);
    is_readable = file >= 0;
    const bool good = is_readable && append_rows(&pool, file, layout, to, &is_readable, error) &&
                      append_events(&pool, file, layout, to, &is_readable, error);
    (void)(file >= 0 && H5Fclose(file));
    if (!is_readable) {
        return evl_error_set(error, EVL_EXIT_IO, path, "cannot be read, or is damaged; begin anew without --continue");
    }
    return good;
}

bool part_size_of(const char *path, part_size *size)
{
    const hid_t file = netcdf_open(path);
    if (file < 0) {
        return false;
    }
    *size = (part_size){(long long)rows_of(file, "time"), 0};
    const hid_t group = H5Lexists(file, "events", H5P_DEFAULT) > 0 ? H5Gopen2(file, "events", H5P_DEFAULT) : -1;
    size->events = group < 0 ? 0 : (long long)rows_of(group, "time");
    (void)(group >= 0 && H5Gclose(group));
    (void)(file >= 0 && H5Fclose(file));
    return group >= 0;
}
