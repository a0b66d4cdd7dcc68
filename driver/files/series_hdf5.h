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
