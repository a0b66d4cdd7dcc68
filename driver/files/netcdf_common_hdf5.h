/** What is the same for all files, and dear to make: it is made once a process. Private to *_hdf5.c. */
#pragma once

#include <hdf5.h>
#include <stdbool.h>

/** How the values of a variable are stored. */
typedef enum {
    STORE_COMPACT, /**< a few, with their description: nothing to find or to write on its own */
    STORE_WHOLE,   /**< in one piece, written all at once */
    STORE_GROWING, /**< in chunks */
    N_STORES
} netcdf_store;

typedef struct {
    bool is_ready;
    hid_t text, references, users; /**< datatypes: variable-length UTF-8; of DIMENSION_LIST; of REFERENCE_LIST */
    hid_t scalar, one;             /**< dataspaces: a scalar, an array of one */
    hid_t transfer; /**< properties of a small transfer: the usual buffer is a megabyte, zeroed each time */
    hid_t access;   /**< properties of a growing variable */
    hid_t creation[N_STORES][2];    /**< properties by the store, and whether it is real: then the fill value is NaN */
    hid_t file_access, file_create; /**< properties of a file that is written */
    hid_t group_create;             /**< properties of a group */
} netcdf_common;

/** All of it, after netcdf_prepare. */
extern netcdf_common netcdf_kept;

/** To come before every other call of the library. */
void netcdf_prepare_library(void);
/** @return false with the reason on HDF5's error stack */
bool netcdf_prepare(void);
