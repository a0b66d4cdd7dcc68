#include "files/series_hdf5.h"

#include "files/netcdf_common_hdf5.h"

enum {
    PIECE_BYTES = 2 * 1024 * 1024,  /* of a variable that is copied */
    CHUNK_BYTES = 64 * 1024 * 1024, /* chunks of all variables together */
    CHUNK_ROWS = 65536
};

static hid_t type_in_memory(const series_column *column)
{
    return series_is_integer(column) ? H5T_NATIVE_INT : H5T_NATIVE_DOUBLE;
}

/** Define a column's variable. @return negative on failure */
static hid_t define(series *rows, netcdf_file *file, hid_t group, const series_column *column)
{
    if (column != rows->columns) {
        return netcdf_define(file, group, &column->variable, rows->chunk_rows);
    }
    return netcdf_define_dimension(file, group, &column->variable, &rows->dimension, rows->chunk_rows)
               ? rows->dimension.scale->dataset
               : H5I_INVALID_HID;
}

bool series_put_whole(series *rows, netcdf_file *file, hid_t group)
{
    /* Readers take a dimension without rows for an unlimited one. */
    const bool is_empty = rows->filled == 0;
    rows->chunk_rows = 1;
    rows->dimension = (netcdf_dimension){.grows = is_empty, .length = rows->filled};
    bool good = true;
    for (int i = 0; i < rows->n_columns && good; i++) {
        const series_column *column = &rows->columns[i];
        const hid_t dataset = define(rows, file, group, column);
        good = dataset >= 0 && (is_empty || netcdf_write(file, dataset, type_in_memory(column), column->block)) &&
               (i == 0 || H5Dclose(dataset) >= 0 || netcdf_fail(file));
    }
    return good && scale_list_users(file, rows->dimension.scale);
}

/** Large chunks, but not larger than the rows need: each is listed in the file, and the list is kept in memory. Unused
 *  space in a chunk takes no space on the disk. */
static hsize_t choose_chunk(const series *rows)
{
    const hsize_t fit = CHUNK_BYTES / series_row_bytes(rows);
    const hsize_t most = rows->limit == 0 ? rows->capacity : fit < CHUNK_ROWS ? fit : CHUNK_ROWS;
    const hsize_t rows_of_chunk = most < rows->capacity ? rows->capacity : most;
    const hsize_t n = (rows->limit + rows_of_chunk - 1) / rows_of_chunk;
    return n == 0 ? rows_of_chunk : (rows->limit + n - 1) / n;
}

bool series_begin(series *rows, netcdf_file *file, hid_t group)
{
    rows->chunk_rows = choose_chunk(rows);
    rows->dimension = (netcdf_dimension){.grows = true, .length = rows->limit};
    bool good = true;
    for (int i = 0; i < rows->n_columns && good; i++) {
        rows->columns[i].dataset = define(rows, file, group, &rows->columns[i]);
        good = rows->columns[i].dataset >= 0;
    }
    return good && scale_list_users(file, rows->dimension.scale);
}

/** Write rows of a column behind the existing ones. @param first  index of the first of them */
static bool write_rows(netcdf_file *file, const series_column *column, hsize_t first, hsize_t n, const void *from)
{
    const netcdf_variable *variable = &column->variable;
    hsize_t extent[NETCDF_MAX_RANK] = {first + n};
    hsize_t start[NETCDF_MAX_RANK] = {first};
    hsize_t count[NETCDF_MAX_RANK] = {n};
    for (int i = 1; i < variable->rank; i++) {
        extent[i] = count[i] = variable->dimensions[i]->length;
    }
    if (H5Dset_extent(column->dataset, extent) < 0) {
        return netcdf_fail(file);
    }
    CLOSED const hid_t on_file = H5Dget_space(column->dataset);
    CLOSED const hid_t in_memory = H5Screate_simple(variable->rank, count, NULL);
    return (on_file >= 0 && in_memory >= 0 &&
            H5Sselect_hyperslab(on_file, H5S_SELECT_SET, start, NULL, count, NULL) >= 0 &&
            H5Dwrite(column->dataset, type_in_memory(column), in_memory, on_file, H5P_DEFAULT, from) >= 0) ||
           netcdf_fail(file);
}

/** Write rows written..filled of the block. */
static bool write_column(const series *rows, netcdf_file *file, const series_column *column)
{
    const char *from = (const char *)column->block + rows->written * (size_t)column->count * series_value_size(column);
    return write_rows(file, column, rows->first + rows->written, rows->filled - rows->written, from);
}

bool series_write(series *rows, netcdf_file *file)
{
    for (int i = 0; i < rows->n_columns && rows->filled > rows->written; i++) {
        if (!write_column(rows, file, &rows->columns[i])) {
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

/* ---- another file ---- */

/** Extent of a variable, if it matches a column. @param[out] extent  along all its dimensions */
static bool find_extent(hid_t space, const series_column *column, hsize_t extent[NETCDF_MAX_RANK])
{
    const int rank = column->variable.rank;
    hsize_t of_row = 1;
    const bool good = space >= 0 && H5Sget_simple_extent_ndims(space) == rank &&
                      H5Sget_simple_extent_dims(space, extent, NULL) == rank;
    for (int i = 1; i < rank && good; i++) {
        of_row *= extent[i];
    }
    return good && of_row == (hsize_t)column->count;
}

bool series_source_open(series_source *source, const series *rows, hid_t group, memory_arena *arena)
{
    *source = (series_source){.datasets = arena_calloc(arena, (size_t)rows->n_columns, sizeof *source->datasets)};
    bool good = true;
    for (int i = 0; i < rows->n_columns && good; i++) {
        hsize_t extent[NETCDF_MAX_RANK] = {0};
        /* Read without a cache, as it was written: a block is a part of a chunk. */
        const hid_t dataset = H5Dopen2(group, rows->columns[i].variable.name, netcdf_cached.access);
        CLOSED const hid_t space = dataset < 0 ? H5I_INVALID_HID : H5Dget_space(dataset);
        source->reason = dataset < 0 ? netcdf_system_reason(NULL) : NULL;
        source->datasets[i] = dataset;
        good = find_extent(space, &rows->columns[i], extent) && (i == 0 || extent[0] == source->rows);
        source->rows = extent[0];
    }
    return good;
}

void series_source_close(series_source *source, const series *rows)
{
    for (int i = 0; i < rows->n_columns; i++) {
        (void)(source->datasets[i] > 0 && H5Dclose(source->datasets[i]));
    }
}

static bool read_rows(const series_column *column, series_source *source, int index, hsize_t from, hsize_t n, void *to)
{
    const hid_t dataset = source->datasets[index];
    hsize_t start[NETCDF_MAX_RANK] = {from}, count[NETCDF_MAX_RANK] = {0};
    CLOSED const hid_t on_file = H5Dget_space(dataset);
    if (!find_extent(on_file, column, count)) {
        return false;
    }
    count[0] = n;
    CLOSED const hid_t in_memory = H5Screate_simple(column->variable.rank, count, NULL);
    if (in_memory < 0 || H5Sselect_hyperslab(on_file, H5S_SELECT_SET, start, NULL, count, NULL) < 0) {
        return false;
    }
    const bool good = H5Dread(dataset, type_in_memory(column), in_memory, on_file, H5P_DEFAULT, to) >= 0;
    source->reason = good ? NULL : netcdf_system_reason(NULL); /* HDF5 discards it in its next call */
    return good;
}

static void shift_coordinate(const series_column *column, size_t n, void *values, int shift)
{
    int *integers = values;
    for (size_t k = 0; k < n && series_is_integer(column); k++) {
        integers[k] += shift;
    }
}

bool series_take(series *rows, series_source *source, int shift)
{
    const size_t available = rows->capacity - rows->filled;
    const size_t n = source->rows - source->next < available ? (size_t)(source->rows - source->next) : available;
    for (int i = 0; i < rows->n_columns; i++) {
        const series_column *column = &rows->columns[i];
        char *to = (char *)column->block + rows->filled * (size_t)column->count * series_value_size(column);
        if (!read_rows(column, source, i, source->next, n, to)) {
            return false;
        }
        shift_coordinate(column, i == 0 ? n : 0, to, shift);
    }
    rows->filled += n;
    source->next += n;
    return true;
}

static bool copy_column(const series *rows, netcdf_file *file, series_source *source, int index, int shift, void *piece)
{
    const series_column *column = &rows->columns[index];
    const hsize_t most = 1 + PIECE_BYTES / ((size_t)column->count * series_value_size(column));
    for (hsize_t done = 0; source->next + done < source->rows;) {
        const hsize_t left = source->rows - source->next - done, n = left < most ? left : most;
        if (!read_rows(column, source, index, source->next + done, n, piece)) {
            return false;
        }
        shift_coordinate(column, index == 0 ? (size_t)n : 0, piece, shift);
        if (!write_rows(file, column, rows->first + done, n, piece)) {
            return false;
        }
        done += n;
    }
    return true;
}

bool series_copy(series *rows, netcdf_file *file, series_source *source, int shift)
{
    size_t largest = 0;
    if (!series_write(rows, file)) {
        return false;
    }
    rows->first += rows->filled;
    rows->filled = rows->written = 0;
    for (int i = 0; i < rows->n_columns; i++) {
        const size_t bytes = (size_t)rows->columns[i].count * sizeof(double);
        largest = bytes > largest ? bytes : largest;
    }
    CLEANUP_FREE void *piece = xcalloc(PIECE_BYTES + largest, 1);
    for (int i = 0; i < rows->n_columns; i++) {
        if (!copy_column(rows, file, source, i, shift, piece)) {
            return false;
        }
    }
    rows->first += source->rows - source->next;
    source->next = source->rows;
    return true;
}
