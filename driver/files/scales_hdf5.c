#include "files/scales_hdf5.h"

#include "files/netcdf_hdf5.h"

#include <hdf5_hl.h>
#include <string.h>

bool scale_make(dimension_scale *scale, hid_t dataset, const char *name)
{
    *scale = (dimension_scale){.dataset = dataset};
    return H5DSset_scale(dataset, name) >= 0 && H5Rcreate(&scale->reference, dataset, ".", H5R_OBJECT, -1) >= 0;
}

bool scales_attach(netcdf_file *file, hid_t dataset, int rank, dimension_scale *const *scales)
{
    hobj_ref_t reference;
    hvl_t list[NETCDF_MAX_RANK];
    if (rank == 0) {
        return true;
    }
    if (H5Rcreate(&reference, dataset, ".", H5R_OBJECT, -1) < 0) {
        return netcdf_fail(file);
    }
    for (int i = 0; i < rank; i++) {
        dimension_scale *scale = scales[i];
        list[i] = (hvl_t){.len = 1, .p = &scale->reference};
        if (scale->n_users == scale->room) {
            scale->room = 2 * scale->room + 4;
            scale->users =
                pool_grow(&file->pool, scale->users, (size_t)scale->n_users, (size_t)scale->room, sizeof *scale->users);
        }
        scale->users[scale->n_users++] = (scale_user){.dataset = reference, .axis = i};
    }
    CLOSED const hid_t type = H5Tvlen_create(H5T_STD_REF_OBJ);
    return netcdf_put(file, dataset, "DIMENSION_LIST", type, rank, list);
}

bool scale_list_users(netcdf_file *file, dimension_scale *scale)
{
    if (scale->n_users == scale->n_listed) {
        return true;
    }
    CLOSED const hid_t type = H5Tcreate(H5T_COMPOUND, sizeof(scale_user));
    if (H5Tinsert(type, "dataset", HOFFSET(scale_user, dataset), H5T_STD_REF_OBJ) < 0 ||
        H5Tinsert(type, "dimension", HOFFSET(scale_user, axis), H5T_NATIVE_INT) < 0) {
        return netcdf_fail(file);
    }
    scale->n_listed = scale->n_users;
    return netcdf_put(file, scale->dataset, "REFERENCE_LIST", type, scale->n_users, scale->users);
}
