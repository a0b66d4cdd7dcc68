/** Rows of numbers along one growing dimension, stored in memory by columns. series_hdf5.h writes them. */
#pragma once

#include "base/memory.h"
#include "files/netcdf_variable.h"

#include <stddef.h>
#include <stdint.h>

typedef struct {
    netcdf_variable variable;
    int offset, count; /**< position in a row */
    int64_t dataset;   /**< HDF5 identifier of a variable that grows on file */
    void *block;       /**< [capacity * count] double or int, part of the series' block */
} series_column;

typedef struct {
    char *reason;               /**< [NETCDF_REASON_LENGTH] why a row was not accepted */
    netcdf_dimension dimension; /**< the growing one; column 0 is its coordinate */
    int n_columns;
    series_column *columns;
    void *block;                   /**< owns the memory of all columns */
    size_t capacity;               /**< rows of the block */
    size_t filled;                 /**< rows in the block */
    size_t written;                /**< rows of the block that are also on file, for a series that grows there */
    unsigned long long first;      /**< index of the block's first row */
    unsigned long long limit;      /**< largest number of rows; 0 if unknown */
    unsigned long long chunk_rows; /**< of a variable that grows */
} series;

/** An empty series with space for n_columns.
 *  @param reason  as in the series; must outlive it
 *  @param limit   largest number of rows; 0 if unknown */
void series_init(series *rows, char *reason, memory_arena *arena, int n_columns, unsigned long long limit);
/** Add the next column; the first is the coordinate, which is not part of a row.
 *  @param variable  its dimensions are those besides the growing one
 *  @param offset    of its `count` values in a row */
void series_add_column(series *rows, const netcdf_variable *variable, int offset, int count);
/** After the last column: allocate memory for at most max_rows rows, fewer if they need more than a few megabytes. */
void series_start(series *rows, size_t max_rows);
void series_free(series *rows);

/** Append rows, integers as whole doubles, as far as there is space: value v of row k is values[v * stride + k].
 *  @return number of rows appended; -1 if an integer value is invalid */
int series_append(series *rows, int n, const double *positions, const double *values, int stride);
/** Enlarge a series without rows on file. @return false if it would be too large: it has to grow on file */
bool series_enlarge(series *rows);
/** Enlarge a series that is never written to a file, without limit. */
void series_widen(series *rows);

/** Whether a column holds int, else double. */
static inline bool series_is_integer(const series_column *column)
{
    return column->variable.type == NETCDF_INTEGER;
}
/** Bytes of one of its values. */
static inline size_t series_value_size(const series_column *column)
{
    return series_is_integer(column) ? sizeof(int) : sizeof(double);
}
/** Bytes of a row in the block. */
size_t series_row_bytes(const series *rows);
