/** Rows of numbers along one growing dimension, held in memory by columns. While all of them are there they can be written as a
 *  whole, as often as one likes; when they are too many, the variables grow in a file from block to block. */
#pragma once

#include "files/netcdf_hdf5.h"

#include <stddef.h>

typedef struct {
    netcdf_variable variable;
    int offset, count; /**< place in a row */
    hid_t dataset;     /**< of a growing variable */
    void *block;       /**< [capacity * count] double or int, part of the series' block */
} series_column;

typedef struct {
    netcdf_file *file;
    netcdf_dimension dimension; /**< the growing one; column 0 is its coordinate */
    int n_columns;
    series_column *columns;
    void *block;        /**< of all columns */
    size_t capacity;    /**< rows of the block */
    size_t filled;      /**< rows in the block */
    size_t written;     /**< those of them that are on file as well, of a series that grows there */
    hsize_t first;      /**< index of the block's first row */
    hsize_t limit;      /**< the most rows there can be; 0 if that is not known */
    hsize_t chunk_rows; /**< of a variable that grows */
} series;

/** An empty series with room for n_columns.
 *  @param limit  the most rows it can get; 0 if that is not known */
void series_init(series *rows, netcdf_file *file, memory_pool *pool, int n_columns, hsize_t limit);
/** Add the next column; the first is the coordinate, which is no part of a row.
 *  @param variable  its dimensions are those besides the growing one
 *  @param offset    of its `count` values in a row */
void series_add_column(series *rows, const netcdf_variable *variable, int offset, int count);
/** After the last column: take memory for at most max_rows rows, fewer if they need more than a few megabytes. */
void series_start(series *rows, size_t max_rows);
void series_free(series *rows);

/** Take rows, integers as whole doubles, as far as there is room: value v of row k is values[v * stride + k].
 *  @return how many of them were taken; -1 if an integer is none */
int series_append(series *rows, int n, const double *places, const double *values, int stride);
/** More room for a series of which no row is on file. @return false if it would be too much: it has to grow on file */
bool series_make_room(series *rows);

/** Define all variables in a group with all rows, and write them. Every row is in the block, and stays there. */
bool series_put_whole(series *rows, hid_t group);
/** Define all variables in a group, to grow there. */
bool series_begin(series *rows, hid_t group);
/** Put on file what is only in memory; a full block is empty then. */
bool series_write(series *rows);
