#include "files/netcdf_hdf5.h"

#include "base/memory.h"

#include <hdf5_hl.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/** The system error in an HDF5 message such as "..., errno = 28, error message = '...', ..."; 0 if there is none. */
static int system_error(const char *description)
{
    static const char mark[] = "errno = ";
    const char *at = description == NULL ? NULL : strstr(description, mark);
    return at == NULL ? 0 : (int)strtol(at + sizeof mark - 1, NULL, 10);
}

/** The innermost message is visited first; a system error has priority over any other. */
static herr_t collect_reason(unsigned index, const H5E_error2_t *error, void *data)
{
    netcdf_file *file = data;
    file->system_error = system_error(error->desc);
    if (file->system_error != 0) {
        (void)snprintf(file->reason, sizeof file->reason, "%s", strerror(file->system_error));
        return 1;
    }
    if (index == 0) {
        (void)snprintf(file->reason, sizeof file->reason, "HDF5: %s", error->desc == NULL ? "no reason" : error->desc);
    }
    return 0;
}

/** Reason why an identifier could not be closed, of which its owner is not informed. */
static netcdf_file lost;

void netcdf_let_go(const hid_t *identifier)
{
    if (*identifier > 0 && H5Idec_ref(*identifier) < 0) {
        (void)netcdf_fail(&lost);
    }
}

/** Whether a call has failed: then the library is no longer called, since it may crash on data that it could not write. */
static bool is_broken(netcdf_file *file)
{
    if (file->reason[0] == '\0' && lost.reason[0] != '\0') {
        file->system_error = lost.system_error;
        (void)snprintf(file->reason, sizeof file->reason, "%s", lost.reason);
    }
    return file->reason[0] != '\0';
}

bool netcdf_fail(netcdf_file *file)
{
    if (file->reason[0] == '\0') {
        (void)H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, collect_reason, file);
    }
    if (file->reason[0] == '\0') {
        (void)snprintf(file->reason, sizeof file->reason, "HDF5 reports no reason");
    }
    return false;
}

/** Return an identifier created by a call; on failure store the reason. */
static hid_t checked(netcdf_file *file, hid_t made)
{
    (void)(made >= 0 || netcdf_fail(file));
    return made;
}

void netcdf_library_version(unsigned version[3])
{
    netcdf_prepare_library();
    (void)H5get_libversion(&version[0], &version[1], &version[2]);
}

bool netcdf_create(netcdf_file *file, const char *path)
{
    file->id = netcdf_prepare() ? H5Fcreate(path, H5F_ACC_TRUNC, netcdf_cached.file_create, netcdf_cached.file_access)
                                : H5I_INVALID_HID;
    return file->id >= 0 || netcdf_fail(file);
}

bool netcdf_flush(netcdf_file *file)
{
    return !is_broken(file) && (H5Fflush(file->id, H5F_SCOPE_GLOBAL) >= 0 || netcdf_fail(file));
}

bool netcdf_close(netcdf_file *file)
{
    arena_free(&file->arena);
    return !is_broken(file) && (H5Fclose(file->id) >= 0 || netcdf_fail(file));
}

hid_t netcdf_create_group(netcdf_file *file, const char *name)
{
    return checked(file, H5Gcreate2(file->id, name, H5P_DEFAULT, netcdf_cached.group_create, H5P_DEFAULT));
}

hid_t netcdf_open(const char *path)
{
    netcdf_prepare_library();
    (void)H5Eset_auto2(H5E_DEFAULT, NULL, NULL);
    return H5Fopen(path, H5F_ACC_RDONLY, H5P_DEFAULT);
}

const char *netcdf_system_reason(const char *otherwise)
{
    static netcdf_file failed; /* its text must outlive the call */
    failed = (netcdf_file){0};
    (void)netcdf_fail(&failed);
    return failed.system_error != 0 ? failed.reason : otherwise;
}

/** Add the CF attributes by which readers convert numbers to words. */
static bool add_flags(netcdf_file *file, hid_t dataset, const netcdf_variable *variable)
{
    CLEANUP_FREE int *values = xcalloc((size_t)variable->n_flags, sizeof *values);
    for (int i = 0; i < variable->n_flags; i++) {
        values[i] = i;
    }
    return netcdf_add(file, dataset, "flag_values", H5T_NATIVE_INT, variable->n_flags, values) &&
           netcdf_add_text(file, dataset, "flag_meanings", variable->flag_meanings);
}

static hid_t element_type(netcdf_type type)
{
    const hid_t types[] = {[NETCDF_REAL] = H5T_NATIVE_DOUBLE,
                           [NETCDF_FLOAT] = H5T_NATIVE_FLOAT,
                           [NETCDF_INTEGER] = H5T_NATIVE_INT,
                           [NETCDF_LONG] = H5T_NATIVE_INT64,
                           [NETCDF_TEXT] = netcdf_cached.text};
    return types[type];
}

static bool grows(const netcdf_variable *variable)
{
    return variable->rank > 0 && variable->dimensions[0]->grows;
}

static hid_t create_space(const netcdf_variable *variable)
{
    hsize_t extent[NETCDF_MAX_RANK], limit[NETCDF_MAX_RANK];
    for (int i = 0; i < variable->rank; i++) {
        extent[i] = limit[i] = variable->dimensions[i]->length;
    }
    if (grows(variable)) {
        extent[0] = 0;
        /* Readers rely on the length of a limited dimension; some search for an unlimited one in every variable. */
        limit[0] = limit[0] == 0 ? H5S_UNLIMITED : limit[0];
    }
    return H5Screate_simple(variable->rank, extent, limit);
}

static bool set_chunks(const netcdf_variable *variable, hsize_t chunk_rows, hid_t creation)
{
    hsize_t chunk[NETCDF_MAX_RANK] = {chunk_rows};
    for (int i = 1; i < variable->rank; i++) {
        chunk[i] = variable->dimensions[i]->length;
    }
    return H5Pset_chunk(creation, variable->rank, chunk) >= 0;
}

/** Whether a variable is small enough for the object header, which is limited to 64 kilobytes. */
static bool is_small(const netcdf_variable *variable)
{
    const hsize_t few = 512;
    hsize_t n = 1;
    for (int i = 0; i < variable->rank; i++) {
        n = n > few ? n : n * variable->dimensions[i]->length;
    }
    return n > 0 && n <= few;
}

/** Properties for early allocation of the whole variable, filled with NaN: its rows are written without the library. */
static hid_t allocate_early(void)
{
    const hid_t creation = H5Pcopy(netcdf_cached.creation[STORE_WHOLE][true]);
    (void)H5Pset_alloc_time(creation, H5D_ALLOC_TIME_EARLY);
    return creation;
}

static hid_t create_dataset(netcdf_file *file, hid_t group, const netcdf_variable *variable, hsize_t chunk_rows)
{
    const bool is_early = variable->type == NETCDF_FLOAT;
    const netcdf_store store = grows(variable) ? STORE_GROWING : is_small(variable) ? STORE_COMPACT : STORE_WHOLE;
    CLOSED const hid_t early = is_early ? allocate_early() : 0;
    const hid_t creation = is_early ? early : netcdf_cached.creation[store][variable->type == NETCDF_REAL];
    const hid_t access = store == STORE_GROWING ? netcdf_cached.access : H5P_DEFAULT;
    CLOSED const hid_t array = variable->rank == 0 ? 0 : create_space(variable);
    const hid_t space = variable->rank == 0 ? netcdf_cached.scalar : array;
    const bool ready = space >= 0 && (store != STORE_GROWING || set_chunks(variable, chunk_rows, creation));
    return checked(file, ready ? H5Dcreate2(group, variable->name, element_type(variable->type), space, H5P_DEFAULT,
                                            creation, access)
                               : H5I_INVALID_HID);
}

static bool add_variable_attributes(netcdf_file *file, hid_t dataset, const netcdf_variable *variable)
{
    const double missing = NAN;
    const float missing_float = NAN;
    return netcdf_add_text(file, dataset, "units", variable->units) &&
           netcdf_add_text(file, dataset, "long_name", variable->long_name) &&
           netcdf_add_text(file, dataset, "symbol", variable->symbol) &&
           (variable->rates == NULL || netcdf_add_text(file, dataset, "rates", variable->rates)) &&
           (variable->type != NETCDF_REAL || netcdf_add(file, dataset, "_FillValue", H5T_NATIVE_DOUBLE, 1, &missing)) &&
           (variable->type != NETCDF_FLOAT ||
            netcdf_add(file, dataset, "_FillValue", H5T_NATIVE_FLOAT, 1, &missing_float)) &&
           (variable->n_flags == 0 || add_flags(file, dataset, variable));
}

/** Make a dataset the scale `name`. @return false with the reason on HDF5's error stack */
static bool scale_make(dimension_scale *scale, hid_t dataset, const char *name)
{
    *scale = (dimension_scale){.dataset = dataset};
    return H5DSset_scale(dataset, name) >= 0 && H5Rcreate(&scale->reference, dataset, ".", H5R_OBJECT, -1) >= 0;
}

/** Attach a scale to every axis of a dataset; the scales list their users later. */
static bool scales_attach(netcdf_file *file, hid_t dataset, int rank, dimension_scale *const *scales)
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
        if (scale->n_users == scale->capacity) {
            scale->capacity = 2 * scale->capacity + 4;
            scale->users = arena_grow(&file->arena, scale->users, (size_t)scale->n_users, (size_t)scale->capacity,
                                      sizeof *scale->users);
        }
        scale->users[scale->n_users++] = (scale_user){.dataset = reference, .axis = i};
    }
    return netcdf_add(file, dataset, "DIMENSION_LIST", netcdf_cached.references, rank, list);
}

bool scale_list_users(netcdf_file *file, dimension_scale *scale)
{
    if (scale == NULL || scale->n_users == scale->n_listed) {
        return true;
    }
    const bool is_first = scale->n_listed == 0;
    scale->n_listed = scale->n_users;
    return (is_first ? netcdf_add : netcdf_put)(file, scale->dataset, "REFERENCE_LIST", netcdf_cached.users,
                                                scale->n_users, scale->users);
}

hid_t netcdf_define(netcdf_file *file, hid_t group, const netcdf_variable *variable, hsize_t chunk_rows)
{
    const hid_t dataset = create_dataset(file, group, variable, chunk_rows);
    if (dataset < 0 || !add_variable_attributes(file, dataset, variable)) {
        return H5I_INVALID_HID;
    }
    dimension_scale *scales[NETCDF_MAX_RANK];
    for (int i = 0; i < variable->rank; i++) {
        scales[i] = variable->dimensions[i]->scale;
    }
    return scales_attach(file, dataset, variable->rank, scales) ? dataset : H5I_INVALID_HID;
}

bool netcdf_define_dimension(netcdf_file *file, hid_t group, const netcdf_variable *coordinate,
                             netcdf_dimension *dimension, hsize_t chunk_rows)
{
    netcdf_variable variable = *coordinate;
    variable.rank = 1;
    variable.dimensions[0] = dimension;
    dimension->name = variable.name;
    dimension->scale = arena_calloc(&file->arena, 1, sizeof *dimension->scale);
    const hid_t dataset = create_dataset(file, group, &variable, chunk_rows);
    return dataset >= 0 && (scale_make(dimension->scale, dataset, variable.name) || netcdf_fail(file)) &&
           add_variable_attributes(file, dataset, &variable);
}

bool netcdf_write(netcdf_file *file, hid_t dataset, hid_t type, const void *values)
{
    return H5Dwrite(dataset, type, H5S_ALL, H5S_ALL, netcdf_cached.transfer, values) >= 0 || netcdf_fail(file);
}

bool netcdf_define_values(netcdf_file *file, hid_t group, netcdf_dimension *dimension, const netcdf_variable *variable,
                          long n, hid_t type, const void *values)
{
    *dimension = (netcdf_dimension){.length = (hsize_t)n};
    return netcdf_define_dimension(file, group, variable, dimension, 0) &&
           (n == 0 || netcdf_write(file, dimension->scale->dataset, type, values));
}
