#include "files/series_hdf5.h"

#include "files/netcdf_common_hdf5.h"

#include <math.h>
#include <string.h>

enum {
    HELD_BYTES = 4 * 1024 * 1024,   /* the most that is held of rows that may all fit */
    BLOCK_BYTES = 3 * 512 * 1024,   /* a block of rows that do not */
    GROWN_BYTES = 1024 * 1024,      /* the most to which a block is enlarged */
    CHUNK_BYTES = 64 * 1024 * 1024, /* chunks of all variables together */
    CHUNK_ROWS = 65536
};

static bool is_integer(const series_column *column)
{
    return column->variable.type == NETCDF_INTEGER;
}

/** Bytes of a value. */
static size_t size_of(const series_column *column)
{
    return is_integer(column) ? sizeof(int) : sizeof(double);
}

void series_init(series *rows, netcdf_file *file, memory_pool *pool, int n_columns, hsize_t limit)
{
    *rows = (series){.file = file, .limit = limit};
    rows->columns = pool_calloc(pool, (size_t)n_columns, sizeof *rows->columns);
}

void series_add_column(series *rows, const netcdf_variable *variable, int offset, int count)
{
    series_column *column = &rows->columns[rows->n_columns];
    column->variable = *variable;
    column->variable.rank = variable->rank + 1;
    column->variable.dimensions[0] = &rows->dimension;
    for (int i = 0; i < variable->rank; i++) {
        column->variable.dimensions[i + 1] = variable->dimensions[i];
    }
    column->offset = offset;
    column->count = count;
    rows->n_columns++;
}

/* ---- the block ---- */

/** Bytes of a row, doubles everywhere: so each column begins where a double may. */
static size_t row_bytes(const series *rows)
{
    size_t bytes = sizeof(double); /* of the coordinate */
    for (int i = 1; i < rows->n_columns; i++) {
        bytes += (size_t)rows->columns[i].count * sizeof(double);
    }
    return bytes;
}

/** A block for so many rows, with those that are there. One piece for all columns, which is not touched before it is used. */
static void take_block(series *rows, size_t capacity)
{
    char *block = xrealloc(NULL, capacity, row_bytes(rows)), *at = block;
    for (int i = 0; i < rows->n_columns; i++) {
        series_column *column = &rows->columns[i];
        const size_t bytes = rows->filled * (size_t)column->count * size_of(column);
        if (bytes > 0) {
            memcpy(at, column->block, bytes);
        }
        column->block = at;
        at += capacity * (size_t)column->count * sizeof(double);
    }
    free(rows->block);
    rows->block = block;
    rows->capacity = capacity;
}

void series_start(series *rows, size_t max_rows)
{
    const size_t bytes = row_bytes(rows), held = HELD_BYTES / bytes, of_block = BLOCK_BYTES / bytes;
    const size_t most = rows->limit == 0 || rows->limit > max_rows ? max_rows : (size_t)rows->limit;
    const size_t fit = most <= held ? most : of_block;
    take_block(rows, fit < 1 ? 1 : fit);
}

bool series_make_room(series *rows)
{
    const size_t more = 4 * rows->capacity;
    const bool is_possible =
        (rows->limit == 0 || rows->capacity < rows->limit) && more * row_bytes(rows) <= GROWN_BYTES;
    if (is_possible) {
        take_block(rows, more);
    }
    return is_possible;
}

void series_free(series *rows)
{
    free(rows->block);
    rows->block = NULL;
}

static inline void copy_reals(const series_column *column, double *to, int n, const double *values, int stride)
{
    const int count = column->count;
    const double *from = values + (size_t)column->offset * (size_t)stride;
    if (n == 1) {
        to[0] = from[0]; /* most columns have a value or two */
        for (int v = 1; v < count; v++) {
            to[v] = from[v * stride];
        }
        return;
    }
    for (int v = 0; v < count; v++, from += stride) {
        for (int k = 0; k < n; k++) {
            to[k * count + v] = from[k];
        }
    }
}

/** @return false if one of them is none */
static inline bool copy_integers(const series_column *column, int *to, int n, const double *values, int stride)
{
    const int count = column->count;
    const double *from = values + (size_t)column->offset * (size_t)stride;
    for (int v = 0; v < count; v++, from += stride) {
        for (int k = 0; k < n; k++) {
            if (!netcdf_is_integer(from[k])) {
                return false;
            }
            to[k * count + v] = (int)from[k];
        }
    }
    return true;
}

/** Say which integer is none. */
static void refuse_integers(const series *rows, const series_column *column, int n, const double *values, int stride)
{
    for (int v = 0; v < column->count; v++) {
        const double *from = values + (size_t)(column->offset + v) * (size_t)stride;
        (void)netcdf_check_integers(rows->file, column->variable.name, n, from);
    }
}

int series_append(series *rows, int n, const double *places, const double *values, int stride)
{
    const size_t room = rows->capacity - rows->filled;
    const int taken = (size_t)n < room ? n : (int)room;
    bool good = true;
    for (int i = 0; i < rows->n_columns && good; i++) {
        const series_column *column = &rows->columns[i];
        const size_t at = rows->filled * (size_t)column->count;
        const double *from = i == 0 ? places : values;
        if (is_integer(column)) {
            good = copy_integers(column, (int *)column->block + at, taken, from, stride);
            if (!good) {
                refuse_integers(rows, column, taken, from, stride);
            }
        } else {
            copy_reals(column, (double *)column->block + at, taken, from, stride);
        }
    }
    rows->filled += (size_t)(good ? taken : 0);
    return good ? taken : -1;
}

/* ---- the file ---- */

static hid_t type_in_memory(const series_column *column)
{
    return is_integer(column) ? H5T_NATIVE_INT : H5T_NATIVE_DOUBLE;
}

/** Define a column's variable. @return negative if it cannot be */
static hid_t define(series *rows, hid_t group, const series_column *column)
{
    if (column != rows->columns) {
        return netcdf_define(rows->file, group, &column->variable, rows->chunk_rows);
    }
    return netcdf_define_dimension(rows->file, group, &column->variable, &rows->dimension, rows->chunk_rows)
               ? rows->dimension.scale.dataset
               : H5I_INVALID_HID;
}

bool series_put_whole(series *rows, hid_t group)
{
    /* Readers take a dimension without rows for an unlimited one. */
    const bool is_empty = rows->filled == 0;
    rows->chunk_rows = 1;
    rows->dimension = (netcdf_dimension){.grows = is_empty, .length = rows->filled};
    bool good = true;
    for (int i = 0; i < rows->n_columns && good; i++) {
        const series_column *column = &rows->columns[i];
        const hid_t dataset = define(rows, group, column);
        good = dataset >= 0 && (is_empty || netcdf_write(rows->file, dataset, type_in_memory(column), column->block)) &&
               (i == 0 || H5Dclose(dataset) >= 0 || netcdf_fail(rows->file));
    }
    return good && scale_list_users(rows->file, &rows->dimension.scale);
}

/** Large chunks, and no larger than the rows need: each of them has to be listed in the file, and the list kept in memory. The
 *  place in a chunk that has no rows yet takes none on the disk. */
static hsize_t choose_chunk(const series *rows)
{
    const hsize_t fit = CHUNK_BYTES / row_bytes(rows);
    const hsize_t most = rows->limit == 0 ? rows->capacity : fit < CHUNK_ROWS ? fit : CHUNK_ROWS;
    const hsize_t rows_of_chunk = most < rows->capacity ? rows->capacity : most;
    const hsize_t n = (rows->limit + rows_of_chunk - 1) / rows_of_chunk;
    return n == 0 ? rows_of_chunk : (rows->limit + n - 1) / n;
}

bool series_begin(series *rows, hid_t group)
{
    rows->chunk_rows = choose_chunk(rows);
    rows->dimension = (netcdf_dimension){.grows = true, .length = rows->limit};
    bool good = true;
    for (int i = 0; i < rows->n_columns && good; i++) {
        rows->columns[i].dataset = define(rows, group, &rows->columns[i]);
        good = rows->columns[i].dataset >= 0;
    }
    return good && scale_list_users(rows->file, &rows->dimension.scale);
}

/** Rows written..filled of the block, behind those that the dataset has already. */
static bool write_column(series *rows, const series_column *column)
{
    const netcdf_variable *variable = &column->variable;
    const char *from = (const char *)column->block + rows->written * (size_t)column->count * size_of(column);
    hsize_t extent[NETCDF_MAX_RANK] = {rows->first + rows->filled};
    hsize_t start[NETCDF_MAX_RANK] = {rows->first + rows->written};
    hsize_t count[NETCDF_MAX_RANK] = {rows->filled - rows->written};
    for (int i = 1; i < variable->rank; i++) {
        extent[i] = count[i] = variable->dimensions[i]->length;
    }
    if (H5Dset_extent(column->dataset, extent) < 0) {
        return netcdf_fail(rows->file);
    }
    CLOSED const hid_t on_file = H5Dget_space(column->dataset);
    CLOSED const hid_t in_memory = H5Screate_simple(variable->rank, count, NULL);
    return (on_file >= 0 && in_memory >= 0 &&
            H5Sselect_hyperslab(on_file, H5S_SELECT_SET, start, NULL, count, NULL) >= 0 &&
            H5Dwrite(column->dataset, type_in_memory(column), in_memory, on_file, H5P_DEFAULT, from) >= 0) ||
           netcdf_fail(rows->file);
}

bool series_write(series *rows)
{
    for (int i = 0; i < rows->n_columns && rows->filled > rows->written; i++) {
        if (!write_column(rows, &rows->columns[i])) {
            return false;
        }
    }
    rows->written = rows->filled;
    if (rows->filled == rows->capacity) {
        rows->first += rows->filled;
        rows->filled = rows->written = 0;
    }
    return true;
}
