/** Histories of a shard's cases, stacked along a dimension case, on file. The interface is independent of HDF5;
 *  stack_hdf5.c uses it.
 *
 *  The complete file is created before the first case runs. Then rows are written in place, bypassing HDF5: the file
 *  remains readable however the program ends.
 *
 *  HDF5's metadata precede all histories and have a checksum. */
#pragma once

#include "base/memory.h"
#include "base/status.h"
#include "files/history.h"

#include <stdbool.h>
#include <stdint.h>

typedef struct {
    const char *path;
    const char *hash;        /**< of the design */
    long first_case, stride; /**< row r belongs to case first_case + r stride */
    long n_rows;
    history_coordinate axis; /**< of each history */
    int n_variables;
    const model_output *variables;
    const model_names *names;
} stack_layout;

typedef struct stack {
    memory_arena arena; /**< owns the path and the arrays */
    char *path;
    int descriptor;
    int n_positions, n_variables;
    int *counts;        /**< [n_variables] values per position of the axis */
    long long *offsets; /**< [n_variables] of row 0 in the file, bytes */
} stack;

/** Open the file, or create it filled with NaN. @return false with the reason in `error`: EVL_EXIT_CASE for another
 *  design's file, EVL_EXIT_IO */
bool stack_open(stack *stack, const stack_layout *layout, evl_error *error);
/** Number of values of a row. */
long stack_row_length(const stack *stack);
/** Write a row: all positions of the first variable, then of the next. Any process may write its own rows. */
bool stack_write(const stack *stack, long row, const float *values, evl_error *error);
/** Checksum of a row, crc32 of its bytes, recorded in the journal. */
uint32_t stack_check(const stack *stack, const float *values);
/** Synchronise the file to the disk. */
bool stack_sync(const stack *stack, evl_error *error);
void stack_close(stack *stack);
