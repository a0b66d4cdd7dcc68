/** Dimension scales as stored by the HDF5 specification, with attributes written once.
 *
 *  H5DSattach_scale gives the same file, but rewrites a scale's list of users with every further user: a fifth of the
 *  cost of a short history. */
#pragma once

#include <hdf5.h>
#include <stdbool.h>

/** One entry of a scale's REFERENCE_LIST. */
typedef struct {
    hobj_ref_t dataset;
    int axis;
} scale_user;

typedef struct dimension_scale {
    hid_t dataset; /**< of the coordinate; not owned */
    hobj_ref_t reference;
    int n_users, n_listed, room; /**< n_listed: number of users on file */
    scale_user *users;           /**< [n_users] */
} dimension_scale;

struct netcdf_file;

/** Make a dataset the scale `name`. @return false with the reason on HDF5's error stack */
bool scale_make(dimension_scale *scale, hid_t dataset, const char *name);
/* Each of these functions returns false with the reason in the file. */
/** Attach a scale to every axis of a dataset; the scales list their users later. */
bool scales_attach(struct netcdf_file *file, hid_t dataset, int rank, dimension_scale *const *scales);
/** Required after the last user, and before a flush: write the list of users, if there are new ones. No effect for
 *  NULL. */
bool scale_list_users(struct netcdf_file *file, dimension_scale *scale);
