/** Conventions of netCDF-4 needed for histories, on plain HDF5: named dimensions attached to every axis, attributes as
 *  expected by readers.
 *
 *  Every function that can fail returns false, or a negative identifier, and stores the reason of the first failure in
 *  the netcdf_file. Nothing is printed. */
#pragma once

#include "base/memory.h"
#include "files/netcdf_common_hdf5.h"
#include "files/netcdf_variable.h"
#include "model/model.h"

#include <hdf5.h>
#include <stdbool.h>

/** Attribute of a local identifier that is closed at every exit from its block; 0 and less: nothing to close. */
#define CLOSED __attribute__((cleanup(netcdf_let_go)))
/** Close an identifier. A failure is stored for netcdf_flush and netcdf_close: the library defers writes until a
 *  dataset is closed. */
void netcdf_let_go(const hid_t *identifier);

typedef struct netcdf_file {
    memory_arena arena; /**< owns the users of scales, and other data needed while the file is open */
    hid_t id;
    int system_error;                  /**< errno of the first failure, 0 if it was not a system error */
    char reason[NETCDF_REASON_LENGTH]; /**< of the first failure; "" if there was none */
} netcdf_file;

/** A dimension scale as stored by the HDF5 specification, with attributes written once. H5DSattach_scale gives the same
 *  file, but rewrites a scale's list of users with every further user: a fifth of the cost of a short history. */
typedef struct dimension_scale {
    hid_t dataset; /**< of the coordinate; not owned */
    hobj_ref_t reference;
    int n_users, n_listed, capacity; /**< n_listed: number of users on file */
    scale_user *users;               /**< [n_users] */
} dimension_scale;

/** Major, minor, release of the HDF5 library. */
void netcdf_library_version(unsigned version[3]);
/** Create the file, or truncate an existing one. */
bool netcdf_create(netcdf_file *file, const char *path);
bool netcdf_flush(netcdf_file *file);
/** Close the file with all open objects in it, and free its arena. After a failure the file is only abandoned. */
bool netcdf_close(netcdf_file *file);
/** Store the reason of a failed HDF5 call, unless there is an earlier one. @return false */
bool netcdf_fail(netcdf_file *file);

/** Open any file for reading, without locks: shards open files at the same time, in folders that may not support locks.
 *  Negative if it is not an HDF5 file. */
hid_t netcdf_open(const char *path);
/** Directly after a failed open or read: the system error if there is one, else `otherwise`. */
const char *netcdf_system_reason(const char *otherwise);
/** A text attribute, of variable or fixed length, in an arena. NULL if there is none. */
char *netcdf_get_text(hid_t object, const char *name, memory_arena *arena);
/** The numbers of an attribute, converted. @return false if it does not exist or has another length */
bool netcdf_get_numbers(hid_t object, const char *name, hid_t type, int n, void *values);

hid_t netcdf_create_group(netcdf_file *file, const char *name);

/* Set an attribute of a group or variable that does not have it yet. */
/** @param n  length of an array; 0: one value */
bool netcdf_add(netcdf_file *file, hid_t object, const char *name, hid_t type, int n, const void *value);
bool netcdf_add_text(netcdf_file *file, hid_t object, const char *name, const char *text);
/* Same, but replace an older value. */
bool netcdf_put(netcdf_file *file, hid_t object, const char *name, hid_t type, int n, const void *value);
bool netcdf_put_text(netcdf_file *file, hid_t object, const char *name, const char *text);
bool netcdf_put_integer(netcdf_file *file, hid_t object, const char *name, long long value);
bool netcdf_put_number(netcdf_file *file, hid_t object, const char *name, double value);

/** Create a variable with its attributes, its axes attached to their dimensions.
 *  @param chunk_rows  rows of a chunk if the first dimension grows */
hid_t netcdf_define(netcdf_file *file, hid_t group, const netcdf_variable *variable, hsize_t chunk_rows);
/** Create a dimension of given length, with its coordinate variable. */
bool netcdf_define_dimension(netcdf_file *file, hid_t group, const netcdf_variable *coordinate,
                             netcdf_dimension *dimension, hsize_t chunk_rows);
/** Create a dimension with the values of its coordinate variable. Call scale_list_users after its last variable.
 *  @param type  of the values in memory, which may differ from that on file */
bool netcdf_define_values(netcdf_file *file, hid_t group, netcdf_dimension *dimension, const netcdf_variable *variable,
                          long n, hid_t type, const void *values);
/** Write all values of a small variable. @param type  of the values in memory */
bool netcdf_write(netcdf_file *file, hid_t dataset, hid_t type, const void *values);
/** Required after the last variable of a dimension, and before a flush: write the list of its scale's users, if there
 *  are new ones. No effect for NULL. */
bool scale_list_users(netcdf_file *file, dimension_scale *scale);
