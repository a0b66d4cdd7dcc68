/** Dimensions on file. Private to *_hdf5.c. */
#pragma once

#include "files/dimensions.h"
#include "files/netcdf_hdf5.h"

/** Define the existing dimensions, with their coordinates. */
bool dimensions_define(dimensions *dimensions, netcdf_file *file);
/** As scale_list_users, for all of them. */
bool dimensions_finish(dimensions *dimensions, netcdf_file *file);
