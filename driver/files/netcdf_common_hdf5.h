/** Objects common to all files that are expensive to create: created once per process. Private to *_hdf5.c. */
#pragma once

#include <hdf5.h>
#include <stdbool.h>

/** One entry of a scale's REFERENCE_LIST. */
typedef struct {
    hobj_ref_t dataset;
    int axis;
} scale_user;

/** Storage of the values of a variable. */
typedef enum {
    STORE_COMPACT, /**< a few, with their description: no separate access or write */
    STORE_WHOLE,   /**< contiguous, written at once */
    STORE_GROWING, /**< in chunks */
    N_STORES
} netcdf_store;

typedef struct {
    bool is_ready;
    hid_t text, references, users; /**< datatypes: variable-length UTF-8; of DIMENSION_LIST; of REFERENCE_LIST */
    hid_t scalar, one;             /**< dataspaces: a scalar, an array of one */
    hid_t transfer; /**< properties of a small transfer: the default buffer is a megabyte, zeroed each time */
    hid_t access;   /**< properties of a growing variable */
    hid_t creation[N_STORES][2]; /**< properties by storage, and whether the type is real: then the fill value is NaN */
    hid_t file_access, file_create; /**< properties of a file that is written */
    hid_t group_create;             /**< properties of a group */
} netcdf_common;

/** All of them, after netcdf_prepare. */
extern netcdf_common netcdf_cached;

/** Required before every other call of the library. */
void netcdf_prepare_library(void);
/** @return false with the reason on HDF5's error stack */
bool netcdf_prepare(void);
