/** Rows on file. While all of them are in memory they can be written as a whole, as often as one likes; when they are too many, the
 *  variables grow in a file from block to block. */
#pragma once

#include "files/netcdf_hdf5.h"
#include "files/series.h"

/** Define all variables in a group with all rows, and write them. Every row is in the block, and stays there. */
bool series_put_whole(series *rows, netcdf_file *file, hid_t group);
/** Define all variables in a group, to grow there. */
bool series_begin(series *rows, netcdf_file *file, hid_t group);
/** Put on file what is only in memory; a full block is empty then. */
bool series_write(series *rows, netcdf_file *file);

/** The same variables in another file, to be read from the first row to the last. */
typedef struct {
    hid_t *datasets; /**< of the columns */
    hsize_t rows, next;
    const char *reason; /**< the system's, why something could not be read; NULL: it gave none */
} series_source;

/** Find the variables of a series in a file or group. @return false if they are not there, or of other sizes */
bool series_source_open(series_source *source, const series *rows, hid_t place, memory_pool *pool);
void series_source_close(series_source *source, const series *rows);
/** Take rows into the block as they lie there, as far as there is room.
 *  @param shift  is added to a coordinate of whole numbers
 *  @return false if they cannot be read */
bool series_take(series *rows, series_source *source, int shift);
/** The same of all rows that are left, past the block: variable by variable in a few large pieces, which costs the least.
 *  @return false with a reason in the file if they cannot be written, without one if they cannot be read */
bool series_copy(series *rows, netcdf_file *file, series_source *source, int shift);
