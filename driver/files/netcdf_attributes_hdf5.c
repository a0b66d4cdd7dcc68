/* Attributes of netcdf_hdf5.h. */
#include "files/netcdf_common_hdf5.h"
#include "files/netcdf_hdf5.h"

#include <string.h>

/* ---- writing ---- */

bool netcdf_add(netcdf_file *file, hid_t object, const char *name, hid_t type, int n, const void *value)
{
    const hsize_t length = (hsize_t)n;
    CLOSED const hid_t array = n > 1 ? H5Screate_simple(1, &length, NULL) : 0;
    const hid_t space = n == 0 ? netcdf_cached.scalar : n == 1 ? netcdf_cached.one : array;
    CLOSED const hid_t attribute = H5Acreate2(object, name, type, space, H5P_DEFAULT, H5P_DEFAULT);
    return (attribute >= 0 && H5Awrite(attribute, type, value) >= 0) || netcdf_fail(file);
}

bool netcdf_add_text(netcdf_file *file, hid_t object, const char *name, const char *text)
{
    return netcdf_add(file, object, name, netcdf_cached.text, 0, &text);
}

bool netcdf_put(netcdf_file *file, hid_t object, const char *name, hid_t type, int n, const void *value)
{
    const htri_t exists = H5Aexists(object, name);
    if (exists < 0 || (exists > 0 && H5Adelete(object, name) < 0)) {
        return netcdf_fail(file);
    }
    return netcdf_add(file, object, name, type, n, value);
}

bool netcdf_put_text(netcdf_file *file, hid_t object, const char *name, const char *text)
{
    return netcdf_put(file, object, name, netcdf_cached.text, 0, &text);
}

bool netcdf_put_integer(netcdf_file *file, hid_t object, const char *name, long long value)
{
    return netcdf_put(file, object, name, H5T_NATIVE_LLONG, 0, &value);
}

bool netcdf_put_number(netcdf_file *file, hid_t object, const char *name, double value)
{
    return netcdf_put(file, object, name, H5T_NATIVE_DOUBLE, 0, &value);
}

/* ---- reading ---- */

/** Negative if it does not exist. */
static hid_t open_attribute(hid_t object, const char *name)
{
    return H5Aexists(object, name) > 0 ? H5Aopen(object, name, H5P_DEFAULT) : -1;
}

char *netcdf_get_text(hid_t object, const char *name, memory_arena *arena)
{
    CLOSED const hid_t attribute = open_attribute(object, name);
    if (attribute < 0) {
        return NULL;
    }
    CLOSED const hid_t type = H5Aget_type(attribute), space = H5Aget_space(attribute);
    if (H5Tget_class(type) != H5T_STRING || H5Sget_simple_extent_npoints(space) > 1) {
        return NULL;
    }
    if (H5Sget_simple_extent_type(space) == H5S_NULL) {
        return arena_copy(arena, ""); /* h5py's representation of an empty text of fixed length */
    }
    const bool is_variable = H5Tis_variable_str(type) > 0;
    CLEANUP_FREE char *fixed = xcalloc(H5Tget_size(type) + 1, 1);
    char *text = is_variable ? NULL : fixed;
    if (H5Aread(attribute, type, is_variable ? (void *)&text : text) < 0) {
        return NULL;
    }
    char *result = arena_copy(arena, text == NULL ? "" : text);
    (void)(is_variable && H5free_memory(text));
    return result;
}

bool netcdf_get_numbers(hid_t object, const char *name, hid_t type, int n, void *values)
{
    CLOSED const hid_t attribute = open_attribute(object, name);
    CLOSED const hid_t space = attribute < 0 ? -1 : H5Aget_space(attribute);
    CLOSED const hid_t stored = attribute < 0 ? -1 : H5Aget_type(attribute);
    const H5T_class_t class = stored < 0 ? H5T_NO_CLASS : H5Tget_class(stored);
    return (class == H5T_INTEGER || class == H5T_FLOAT) && H5Sget_simple_extent_npoints(space) == n &&
           H5Aread(attribute, type, values) >= 0;
}
