/** Rows of numbers along one growing dimension, buffered in memory and written a chunk at a time.
 *
 *  The variables are created with the first write, because only then is it known whether the rows are many: a short
 *  series gets chunks of its own length. */
#pragma once

#include "files/netcdf_hdf5.h"

#include <stddef.h>

typedef struct {
    netcdf_variable variable;
    int offset, count; /**< place in a row */
    hid_t dataset;
    void *block; /**< [capacity * count] double or int, part of the series' block */
} series_column;

typedef struct {
    netcdf_file *file;
    hid_t group;
    netcdf_dimension dimension; /**< the growing one; column 0 is its coordinate */
    int n_columns;
    series_column *columns;
    void *block;     /**< of all columns */
    size_t capacity; /**< rows of the block in memory, and of a chunk */
    size_t filled;   /**< rows in the block */
    size_t written;  /**< those of them that are on file as well */
    hsize_t first;   /**< index of the block's first row */
    bool is_defined;
} series;

/** An empty series in a group, with room for n_columns.
 *  @param limit  the most rows it can get; 0 if that is not known */
void series_init(series *rows, netcdf_file *file, hid_t group, int n_columns, hsize_t limit);
/** Add the next column; the first is the coordinate.
 *  @param variable  its dimensions are those besides the growing one
 *  @param offset    of its `count` values in a row */
void series_add_column(series *rows, const netcdf_variable *variable, int offset, int count);
/** After the last column: take memory for at most max_rows rows, fewer if they need more than a few megabytes. */
void series_start(series *rows, size_t max_rows);
/** Add one row; integers as whole doubles. */
bool series_append(series *rows, const double *row);
/** Put on file what is only in memory. `is_last`: no more rows will follow. */
bool series_write(series *rows, bool is_last);
