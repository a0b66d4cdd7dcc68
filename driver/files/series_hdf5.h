/** Rows on file. While all of them are in memory they can be written as a whole, any number of times; when they are too
 *  many, the variables grow in a file block by block. */
#pragma once

#include "files/netcdf_hdf5.h"
#include "files/series.h"

/** Define all variables in a group with all rows, and write them. All rows are in the block, and stay there. */
bool series_put_whole(series *rows, netcdf_file *file, hid_t group);
/** Define all variables in a group, as growing ones. */
bool series_begin(series *rows, netcdf_file *file, hid_t group);
/** Write the rows that are only in memory; a full block is emptied. */
bool series_write(series *rows, netcdf_file *file);

/** The same variables in another file, to be read from the first row to the last. */
typedef struct {
    hid_t *datasets; /**< of the columns */
    hsize_t rows, next;
    const char *reason; /**< system error of a failed read; NULL: none */
} series_source;

/** Find the variables of a series in a file or group. @return false if they do not exist, or have other sizes */
bool series_source_open(series_source *source, const series *rows, hid_t group, memory_arena *arena);
void series_source_close(series_source *source, const series *rows);
/** Read rows into the block, as far as there is space.
 *  @param shift  added to a coordinate of integers
 *  @return false if they cannot be read */
bool series_take(series *rows, series_source *source, int shift);
/** Copy all remaining rows directly to the file: variable by variable in a few large pieces, which is the fastest way.
 *  @return false with a reason in the file if they cannot be written, without one if they cannot be read */
bool series_copy(series *rows, netcdf_file *file, series_source *source, int shift);
