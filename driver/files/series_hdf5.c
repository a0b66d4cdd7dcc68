#include "files/series_hdf5.h"

#include "files/netcdf_common_hdf5.h"

enum {
    CHUNK_BYTES = 64 * 1024 * 1024, /* chunks of all variables together */
    CHUNK_ROWS = 65536
};

static hid_t type_in_memory(const series_column *column)
{
    return series_is_integer(column) ? H5T_NATIVE_INT : H5T_NATIVE_DOUBLE;
}

/** Define a column's variable. @return negative if it cannot be */
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

/** Large chunks, and no larger than the rows need: each of them has to be listed in the file, and the list kept in memory. The
 *  place in a chunk that has no rows yet takes none on the disk. */
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

/** Rows written..filled of the block, behind those that the dataset has already. */
static bool write_column(const series *rows, netcdf_file *file, const series_column *column)
{
    const netcdf_variable *variable = &column->variable;
    const size_t size = series_is_integer(column) ? sizeof(int) : sizeof(double);
    const char *from = (const char *)column->block + rows->written * (size_t)column->count * size;
    hsize_t extent[NETCDF_MAX_RANK] = {rows->first + rows->filled};
    hsize_t start[NETCDF_MAX_RANK] = {rows->first + rows->written};
    hsize_t count[NETCDF_MAX_RANK] = {rows->filled - rows->written};
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
