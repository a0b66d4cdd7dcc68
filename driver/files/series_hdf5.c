#include "files/series_hdf5.h"

#include <math.h>
#include <string.h>

enum { BLOCK_BYTES = 4 * 1024 * 1024 };

static bool is_integer(const series_column *column)
{
    return column->variable.type == NETCDF_INTEGER;
}

void series_init(series *rows, netcdf_file *file, hid_t group, int n_columns, hsize_t limit)
{
    *rows = (series){.file = file, .group = group, .dimension = {.grows = true, .length = limit}};
    rows->columns = pool_calloc(&file->pool, (size_t)n_columns, sizeof *rows->columns);
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

void series_start(series *rows, size_t max_rows)
{
    size_t row_bytes = 0;
    for (int i = 0; i < rows->n_columns; i++) {
        row_bytes += (size_t)rows->columns[i].count * sizeof(double);
    }
    const size_t fit = row_bytes == 0 ? max_rows : BLOCK_BYTES / row_bytes;
    rows->capacity = fit > max_rows ? max_rows : fit < 1 ? 1 : fit;
    /* One piece for all columns: the system gives it zeroed, small ones would be zeroed by hand. */
    rows->block = pool_calloc(&rows->file->pool, rows->capacity, row_bytes);
    char *at = rows->block;
    for (int i = 0; i < rows->n_columns; i++) {
        rows->columns[i].block = at;
        at += rows->capacity * (size_t)rows->columns[i].count * sizeof(double);
    }
}

static bool copy_integers(series *rows, const series_column *column, const double *values)
{
    int *to = (int *)column->block + rows->filled * (size_t)column->count;
    if (!netcdf_check_integers(rows->file, column->variable.name, column->count, values)) {
        return false;
    }
    for (int i = 0; i < column->count; i++) {
        to[i] = (int)lrint(values[i]);
    }
    return true;
}

bool series_append(series *rows, const double *row)
{
    for (int i = 0; i < rows->n_columns; i++) {
        const series_column *column = &rows->columns[i];
        const double *values = row + column->offset;
        const size_t count = (size_t)column->count;
        if (is_integer(column)) {
            if (!copy_integers(rows, column, values)) {
                return false;
            }
        } else {
            double *to = (double *)column->block + rows->filled * count;
            to[0] = values[0]; /* most columns have a value or two: a call to copy them costs more than they do */
            if (count == 2) {
                to[1] = values[1];
            } else if (count > 2) {
                memcpy(to + 1, values + 1, (count - 1) * sizeof *values);
            }
        }
    }
    rows->filled++;
    return rows->filled < rows->capacity || series_write(rows, false);
}

static bool define(series *rows, hsize_t chunk_rows)
{
    series_column *coordinate = &rows->columns[0];
    if (!netcdf_define_dimension(rows->file, rows->group, &coordinate->variable, &rows->dimension, chunk_rows)) {
        return false;
    }
    coordinate->dataset = rows->dimension.scale.dataset;
    bool good = true;
    for (int i = 1; i < rows->n_columns && good; i++) {
        series_column *column = &rows->columns[i];
        column->dataset = netcdf_define(rows->file, rows->group, &column->variable, chunk_rows);
        good = column->dataset >= 0;
    }
    rows->is_defined = true;
    return good && scale_list_users(rows->file, &rows->dimension.scale);
}

/** Rows written..filled of the block, behind those that the dataset has already. */
static bool write_column(series *rows, const series_column *column)
{
    const netcdf_variable *variable = &column->variable;
    const size_t size = is_integer(column) ? sizeof(int) : sizeof(double);
    const char *from = (const char *)column->block + rows->written * (size_t)column->count * size;
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
    const hid_t type = is_integer(column) ? H5T_NATIVE_INT : H5T_NATIVE_DOUBLE;
    return (on_file >= 0 && in_memory >= 0 &&
            H5Sselect_hyperslab(on_file, H5S_SELECT_SET, start, NULL, count, NULL) >= 0 &&
            H5Dwrite(column->dataset, type, in_memory, on_file, H5P_DEFAULT, from) >= 0) ||
           netcdf_fail(rows->file);
}

bool series_write(series *rows, bool is_last)
{
    if (!rows->is_defined) {
        const size_t few = rows->filled > 0 ? rows->filled : 1;
        if (is_last && rows->filled > 0) {
            rows->dimension.length = rows->filled;
        }
        if (!define(rows, is_last ? few : rows->capacity)) {
            return false;
        }
    }
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
