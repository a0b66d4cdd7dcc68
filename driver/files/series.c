#include "files/series.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
    HELD_BYTES = 4 * 1024 * 1024, /* largest memory for rows that may all fit */
    BLOCK_BYTES = 3 * 512 * 1024, /* a block of rows that do not fit */
    GROWN_BYTES = 1024 * 1024     /* largest size of an enlarged block */
};

bool netcdf_are_integers(char *reason, const char *name, int n, const double *values)
{
    for (int i = 0; i < n; i++) {
        if (!netcdf_is_integer(values[i])) {
            if (reason[0] == '\0') {
                (void)snprintf(reason, NETCDF_REASON_LENGTH, "%s = %g is not an integer of 32 bits", name, values[i]);
            }
            return false;
        }
    }
    return true;
}

void series_init(series *rows, char *reason, memory_arena *arena, int n_columns, unsigned long long limit)
{
    *rows = (series){.reason = reason, .limit = limit};
    rows->columns = arena_calloc(arena, (size_t)n_columns, sizeof *rows->columns);
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

/** Doubles for all columns, so that each column is aligned for doubles. */
size_t series_row_bytes(const series *rows)
{
    size_t bytes = sizeof(double); /* of the coordinate */
    for (int i = 1; i < rows->n_columns; i++) {
        bytes += (size_t)rows->columns[i].count * sizeof(double);
    }
    return bytes;
}

/** Allocate a block with the given capacity, and copy the present rows. One allocation for all columns, not touched
 *  before it is used. */
static void take_block(series *rows, size_t capacity)
{
    char *block = xrealloc(NULL, capacity, series_row_bytes(rows)), *at = block;
    for (int i = 0; i < rows->n_columns; i++) {
        series_column *column = &rows->columns[i];
        const size_t bytes = rows->filled * (size_t)column->count * series_value_size(column);
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
    const size_t bytes = series_row_bytes(rows), held = HELD_BYTES / bytes, of_block = BLOCK_BYTES / bytes;
    const size_t most = rows->limit == 0 || rows->limit > max_rows ? max_rows : (size_t)rows->limit;
    const size_t fit = most <= held ? most : of_block;
    take_block(rows, fit < 1 ? 1 : fit);
}

bool series_enlarge(series *rows)
{
    const size_t more = 4 * rows->capacity;
    const bool is_possible =
        (rows->limit == 0 || rows->capacity < rows->limit) && more * series_row_bytes(rows) <= GROWN_BYTES;
    if (is_possible) {
        take_block(rows, more);
    }
    return is_possible;
}

void series_widen(series *rows)
{
    const size_t more = 4 * rows->capacity;
    take_block(rows, rows->limit > rows->capacity && rows->limit < more ? (size_t)rows->limit : more);
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
        to[0] = from[0]; /* most columns have one or two values */
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

/** @return false if one of them is not an integer */
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

/** Report which value is not an integer. */
static void refuse_integers(const series *rows, const series_column *column, int n, const double *values, int stride)
{
    for (int v = 0; v < column->count; v++) {
        const double *from = values + (size_t)(column->offset + v) * (size_t)stride;
        (void)netcdf_are_integers(rows->reason, column->variable.name, n, from);
    }
}

int series_append(series *rows, int n, const double *positions, const double *values, int stride)
{
    const size_t available = rows->capacity - rows->filled;
    const int taken = (size_t)n < available ? n : (int)available;
    bool good = true;
    for (int i = 0; i < rows->n_columns && good; i++) {
        const series_column *column = &rows->columns[i];
        const size_t at = rows->filled * (size_t)column->count;
        const double *from = i == 0 ? positions : values;
        if (series_is_integer(column)) {
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
