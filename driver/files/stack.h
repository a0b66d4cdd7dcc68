/** The histories of a shard's cases, stacked along a dimension case, on file. The interface knows nothing of HDF5;
 *  stack_hdf5.c does.
 *
 *  The whole file is made before the first case runs. After that rows are written in their place, past HDF5: whatever
 *  ends the program, the file can be read.
 *
 *  What HDF5 knows of it stands before all histories and is sealed. */
#pragma once

#include "base/memory.h"
#include "base/status.h"
#include "files/history.h"

#include <stdbool.h>
#include <stdint.h>

typedef struct {
    const char *path;
    const char *hash;        /**< of the design */
    long first_case, stride; /**< row r is that of case first_case + r stride */
    long n_rows;
    history_coordinate axis; /**< along which each history goes */
    int n_variables;
    const model_output *variables;
    const model_names *names;
} stack_layout;

typedef struct stack {
    memory_pool pool; /**< of the path and the arrays */
    char *path;
    int descriptor;
    int n_places, n_variables;
    int *counts;        /**< [n_variables] values a place of the axis */
    long long *offsets; /**< [n_variables] of row 0 in the file, bytes */
} stack;

/** Open the file, or make it, all NaN. @return false with the reason in `error`: EVL_EXIT_CASE for another design's file,
 *  EVL_EXIT_IO */
bool stack_open(stack *stack, const stack_layout *layout, evl_error *error);
/** Number of values of a row. */
long stack_row_length(const stack *stack);
/** Write a row: all places of the first variable, then of the next. Any process may, each its own rows. */
bool stack_write(const stack *stack, long row, const float *values, evl_error *error);
/** The check of a row, crc32 of its bytes, which its record in the journal keeps. */
uint32_t stack_check(const stack *stack, const float *values);
/** Bring to the disk what was written. */
bool stack_sync(const stack *stack, evl_error *error);
void stack_close(stack *stack);
