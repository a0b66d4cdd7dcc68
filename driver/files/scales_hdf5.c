#include "files/scales_hdf5.h"

#include "base/memory.h"

#include <hdf5_hl.h>
#include <stdlib.h>

enum { MAX_RANK = 8 };

/** Create an attribute that is an array, or replace it. */
static bool put_array(hid_t object, const char *name, hid_t type, int n, const void *values)
{
    const hsize_t length = (hsize_t)n;
    const htri_t exists = H5Aexists(object, name);
    if (exists < 0 || (exists > 0 && H5Adelete(object, name) < 0)) {
        return false;
    }
    const hid_t space = H5Screate_simple(1, &length, NULL);
    const hid_t attribute = space < 0 ? -1 : H5Acreate2(object, name, type, space, H5P_DEFAULT, H5P_DEFAULT);
    const bool good = attribute >= 0 && H5Awrite(attribute, type, values) >= 0;
    if (good) { /* a failure keeps its error stack */
        (void)H5Aclose(attribute);
        (void)H5Sclose(space);
    }
    return good;
}

bool scale_make(dimension_scale *scale, hid_t dataset, const char *name)
{
    *scale = (dimension_scale){.dataset = dataset};
    return H5DSset_scale(dataset, name) >= 0 && H5Rcreate(&scale->reference, dataset, ".", H5R_OBJECT, -1) >= 0;
}

bool scales_attach(hid_t dataset, int rank, dimension_scale *const *scales)
{
    hobj_ref_t reference;
    hvl_t list[MAX_RANK];
    if (rank == 0) {
        return true;
    }
    if (rank > MAX_RANK || H5Rcreate(&reference, dataset, ".", H5R_OBJECT, -1) < 0) {
        return false;
    }
    for (int i = 0; i < rank; i++) {
        dimension_scale *scale = scales[i];
        list[i] = (hvl_t){.len = 1, .p = &scale->reference};
        scale->users = xrealloc(scale->users, (size_t)scale->n_users + 1, sizeof *scale->users);
        scale->users[scale->n_users++] = (scale_user){.dataset = reference, .axis = i};
    }
    const hid_t type = H5Tvlen_create(H5T_STD_REF_OBJ);
    const bool good = type >= 0 && put_array(dataset, "DIMENSION_LIST", type, rank, list);
    if (good) {
        (void)H5Tclose(type);
    }
    return good;
}

bool scale_list_users(dimension_scale *scale)
{
    if (scale->n_users == scale->n_listed) {
        return true;
    }
    const hid_t type = H5Tcreate(H5T_COMPOUND, sizeof(scale_user));
    const bool good = type >= 0 && H5Tinsert(type, "dataset", HOFFSET(scale_user, dataset), H5T_STD_REF_OBJ) >= 0 &&
                      H5Tinsert(type, "dimension", HOFFSET(scale_user, axis), H5T_NATIVE_INT) >= 0 &&
                      put_array(scale->dataset, "REFERENCE_LIST", type, scale->n_users, scale->users);
    if (good) {
        (void)H5Tclose(type);
        scale->n_listed = scale->n_users;
    }
    return good;
}

void scale_free(dimension_scale *scale)
{
    free(scale->users);
    *scale = (dimension_scale){0};
}
