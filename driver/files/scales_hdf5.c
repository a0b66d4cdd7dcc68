#include "files/scales_hdf5.h"

#include "files/netcdf_common_hdf5.h"
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
    return netcdf_add(file, dataset, "DIMENSION_LIST", netcdf_kept.references, rank, list);
}

bool scale_list_users(netcdf_file *file, dimension_scale *scale)
{
    if (scale == NULL || scale->n_users == scale->n_listed) {
        return true;
    }
    const bool is_first = scale->n_listed == 0;
    scale->n_listed = scale->n_users;
    return (is_first ? netcdf_add : netcdf_put)(file, scale->dataset, "REFERENCE_LIST", netcdf_kept.users,
                                                scale->n_users, scale->users);
}
