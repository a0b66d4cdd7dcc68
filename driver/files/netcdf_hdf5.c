#include "files/netcdf_hdf5.h"

#include "base/memory.h"

#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/** The system's reason inside an HDF5 message such as "..., errno = 28, error message = '...', ..."; 0 if there is none. */
static int system_error(const char *description)
{
    static const char mark[] = "errno = ";
    const char *at = description == NULL ? NULL : strstr(description, mark);
    return at == NULL ? 0 : (int)strtol(at + sizeof mark - 1, NULL, 10);
}

/** The innermost message comes first; one with a system error is worth more than any other. */
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

bool netcdf_fail(netcdf_file *file)
{
    if (file->reason[0] == '\0') {
        (void)H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, collect_reason, file);
    }
    if (file->reason[0] == '\0') {
        (void)snprintf(file->reason, sizeof file->reason, "HDF5 gives no reason");
    }
    return false;
}

/** An identifier that a call has made; if it failed, the reason is kept. */
static hid_t checked(netcdf_file *file, hid_t made)
{
    (void)(made >= 0 || netcdf_fail(file));
    return made;
}

/** Reproducible files: members in order of creation, as netCDF wants them, and no times. */
static bool set_group_properties(hid_t properties)
{
    const unsigned order = H5P_CRT_ORDER_TRACKED | H5P_CRT_ORDER_INDEXED;
    return H5Pset_link_creation_order(properties, order) >= 0 && H5Pset_obj_track_times(properties, 0) >= 0;
}

/** To come before every other call of the library. After a failed write it could not clean up at exit, and would crash;
 *  and a lock of its own would meet that of the caller, who holds one before the file is emptied. */
static void prepare_library(void)
{
    (void)H5dont_atexit();
    (void)setenv("HDF5_USE_FILE_LOCKING", "FALSE", 1);
}

void netcdf_library_version(unsigned version[3])
{
    prepare_library();
    (void)H5get_libversion(&version[0], &version[1], &version[2]);
}

/* The indices of a long run's chunks would fill the library's cache: 32 megabytes for rows that are never looked at again. */
static bool limit_metadata_cache(hid_t access)
{
    const size_t bytes = 512 * 1024;
    H5AC_cache_config_t config = {.version = H5AC__CURR_CACHE_CONFIG_VERSION};
    if (H5Pget_mdc_config(access, &config) < 0) {
        return false;
    }
    config.set_initial_size = true;
    config.initial_size = config.min_size = config.max_size = bytes;
    return H5Pset_mdc_config(access, &config) >= 0;
}

/** What is the same for all files, and dear to make. */
static struct {
    bool is_ready;
    hid_t text;           /**< datatype: variable-length UTF-8 */
    hid_t scalar;         /**< dataspace */
    hid_t transfer;       /**< properties of a small transfer: the usual buffer is a megabyte, zeroed each time */
    hid_t access;         /**< properties of a growing variable */
    hid_t creation[2][2]; /**< properties by whether a variable grows, and whether it is real */
} common;

/** How variables are stored; a growing one gets its chunks when it is created. */
static bool prepare_storage(void)
{
    const double missing = NAN;
    /* Rows come in order and in whole chunks: a cache would only cost memory, a megabyte a variable, and to fill a chunk
     * beforehand would only cost a copy of each. */
    common.access = H5Pcreate(H5P_DATASET_ACCESS);
    bool good = common.access >= 0 && H5Pset_chunk_cache(common.access, 1, 0, 1.0) >= 0;
    for (int grows = 0; grows < 2; grows++) {
        for (int is_real = 0; is_real < 2; is_real++) {
            const hid_t creation = common.creation[grows][is_real] = H5Pcreate(H5P_DATASET_CREATE);
            good = good && creation >= 0 && H5Pset_obj_track_times(creation, 0) >= 0 &&
                   (!grows || H5Pset_fill_time(creation, H5D_FILL_TIME_NEVER) >= 0) &&
                   (!is_real || H5Pset_fill_value(creation, H5T_NATIVE_DOUBLE, &missing) >= 0);
        }
    }
    return good;
}

static bool prepare_common(void)
{
    const int kept = 64 * 1024; /* bytes of a kind of memory that the library may hoard */
    prepare_library();
    if (common.is_ready || H5open() < 0 || H5Eset_auto2(H5E_DEFAULT, NULL, NULL) < 0 ||
        H5set_free_list_limits(kept, kept, kept, kept, kept, kept) < 0) {
        return common.is_ready;
    }
    common.text = H5Tcopy(H5T_C_S1);
    common.scalar = H5Screate(H5S_SCALAR);
    common.transfer = H5Pcreate(H5P_DATASET_XFER);
    common.is_ready = common.text >= 0 && common.scalar >= 0 && common.transfer >= 0 && prepare_storage() &&
                      H5Pset_buffer(common.transfer, 16 * 1024, NULL, NULL) >= 0 &&
                      H5Tset_size(common.text, H5T_VARIABLE) >= 0 && H5Tset_cset(common.text, H5T_CSET_UTF8) >= 0;
    return common.is_ready;
}

bool netcdf_create(netcdf_file *file, const char *path)
{
    if (!prepare_common()) {
        return netcdf_fail(file);
    }
    CLOSED const hid_t access = H5Pcreate(H5P_FILE_ACCESS), creation = H5Pcreate(H5P_FILE_CREATE);
    /* Format 1.8: later ones mark a file as open for writing, and a killed run's flushed file could not be read. */
    const bool ready = access >= 0 && creation >= 0 &&
                       H5Pset_libver_bounds(access, H5F_LIBVER_V18, H5F_LIBVER_V18) >= 0 &&
                       H5Pset_fclose_degree(access, H5F_CLOSE_STRONG) >= 0 && limit_metadata_cache(access) &&
                       set_group_properties(creation);
    file->id = ready ? H5Fcreate(path, H5F_ACC_TRUNC, creation, access) : H5I_INVALID_HID;
    return file->id >= 0 || netcdf_fail(file);
}

bool netcdf_flush(netcdf_file *file)
{
    return H5Fflush(file->id, H5F_SCOPE_GLOBAL) >= 0 || netcdf_fail(file);
}

bool netcdf_close(netcdf_file *file)
{
    pool_free(&file->pool);
    return H5Fclose(file->id) >= 0 || netcdf_fail(file);
}

hid_t netcdf_create_group(netcdf_file *file, const char *name)
{
    CLOSED const hid_t creation = H5Pcreate(H5P_GROUP_CREATE);
    const bool ready = creation >= 0 && set_group_properties(creation);
    return checked(file, ready ? H5Gcreate2(file->id, name, H5P_DEFAULT, creation, H5P_DEFAULT) : H5I_INVALID_HID);
}

bool netcdf_put(netcdf_file *file, hid_t object, const char *name, hid_t type, int n, const void *value)
{
    const hsize_t length = (hsize_t)n;
    CLOSED const hid_t array = n > 0 ? H5Screate_simple(1, &length, NULL) : 0;
    const htri_t exists = H5Aexists(object, name);
    if (exists < 0 || (exists > 0 && H5Adelete(object, name) < 0)) {
        return netcdf_fail(file);
    }
    CLOSED const hid_t attribute =
        H5Acreate2(object, name, type, n > 0 ? array : common.scalar, H5P_DEFAULT, H5P_DEFAULT);
    return (attribute >= 0 && H5Awrite(attribute, type, value) >= 0) || netcdf_fail(file);
}

bool netcdf_put_text(netcdf_file *file, hid_t object, const char *name, const char *text)
{
    return netcdf_put(file, object, name, common.text, 0, &text);
}

bool netcdf_put_integer(netcdf_file *file, hid_t object, const char *name, long long value)
{
    return netcdf_put(file, object, name, H5T_NATIVE_LLONG, 0, &value);
}

bool netcdf_put_number(netcdf_file *file, hid_t object, const char *name, double value)
{
    return netcdf_put(file, object, name, H5T_NATIVE_DOUBLE, 0, &value);
}

hid_t netcdf_open(const char *path)
{
    prepare_library();
    (void)H5Eset_auto2(H5E_DEFAULT, NULL, NULL);
    return H5Fopen(path, H5F_ACC_RDONLY, H5P_DEFAULT);
}

/** Negative if there is none. */
static hid_t open_attribute(hid_t object, const char *name)
{
    return H5Aexists(object, name) > 0 ? H5Aopen(object, name, H5P_DEFAULT) : -1;
}

char *netcdf_get_text(hid_t object, const char *name, memory_pool *pool)
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
        return pool_copy(pool, ""); /* how h5py writes an empty text of fixed length */
    }
    const bool is_variable = H5Tis_variable_str(type) > 0;
    OWNED char *fixed = xcalloc(H5Tget_size(type) + 1, 1);
    char *text = is_variable ? NULL : fixed;
    if (H5Aread(attribute, type, is_variable ? (void *)&text : text) < 0) {
        return NULL;
    }
    char *result = pool_copy(pool, text == NULL ? "" : text);
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

/** The CF attributes by which a reader turns numbers into words. */
static bool add_flags(netcdf_file *file, hid_t dataset, const netcdf_variable *variable)
{
    OWNED int *values = xcalloc((size_t)variable->n_flags, sizeof *values);
    for (int i = 0; i < variable->n_flags; i++) {
        values[i] = i;
    }
    return netcdf_put(file, dataset, "flag_values", H5T_NATIVE_INT, variable->n_flags, values) &&
           netcdf_put_text(file, dataset, "flag_meanings", variable->flag_meanings);
}

static hid_t element_type(netcdf_type type)
{
    const hid_t types[] = {[NETCDF_REAL] = H5T_NATIVE_DOUBLE,
                           [NETCDF_FLOAT] = H5T_NATIVE_FLOAT,
                           [NETCDF_INTEGER] = H5T_NATIVE_INT,
                           [NETCDF_LONG] = H5T_NATIVE_INT64,
                           [NETCDF_TEXT] = common.text};
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
        /* Readers take a limited dimension at its word; an unlimited one some of them look for in every variable. */
        limit[0] = limit[0] == 0 ? H5S_UNLIMITED : limit[0];
    }
    return variable->rank == 0 ? H5Screate(H5S_SCALAR) : H5Screate_simple(variable->rank, extent, limit);
}

static bool set_chunks(const netcdf_variable *variable, hsize_t chunk_rows, hid_t creation)
{
    hsize_t chunk[NETCDF_MAX_RANK] = {chunk_rows};
    for (int i = 1; i < variable->rank; i++) {
        chunk[i] = variable->dimensions[i]->length;
    }
    return H5Pset_chunk(creation, variable->rank, chunk) >= 0;
}

/** All of the place in the file, filled with NaN: for rows that are written past the library. */
static hid_t take_place_early(void)
{
    const hid_t creation = H5Pcopy(common.creation[false][true]);
    (void)H5Pset_alloc_time(creation, H5D_ALLOC_TIME_EARLY);
    return creation;
}

static hid_t create_dataset(netcdf_file *file, hid_t group, const netcdf_variable *variable, hsize_t chunk_rows)
{
    const bool is_growing = grows(variable), is_early = variable->type == NETCDF_FLOAT;
    CLOSED const hid_t early = is_early ? take_place_early() : 0;
    const hid_t creation = is_early ? early : common.creation[is_growing][variable->type == NETCDF_REAL];
    const hid_t access = is_growing ? common.access : H5P_DEFAULT;
    CLOSED const hid_t space = create_space(variable);
    const bool ready = space >= 0 && (!is_growing || set_chunks(variable, chunk_rows, creation));
    return checked(file, ready ? H5Dcreate2(group, variable->name, element_type(variable->type), space, H5P_DEFAULT,
                                            creation, access)
                               : H5I_INVALID_HID);
}

static bool add_variable_attributes(netcdf_file *file, hid_t dataset, const netcdf_variable *variable)
{
    const double missing = NAN;
    const float missing_float = NAN;
    return netcdf_put_text(file, dataset, "units", variable->units) &&
           netcdf_put_text(file, dataset, "long_name", variable->long_name) &&
           netcdf_put_text(file, dataset, "symbol", variable->symbol) &&
           (variable->type != NETCDF_REAL || netcdf_put(file, dataset, "_FillValue", H5T_NATIVE_DOUBLE, 1, &missing)) &&
           (variable->type != NETCDF_FLOAT ||
            netcdf_put(file, dataset, "_FillValue", H5T_NATIVE_FLOAT, 1, &missing_float)) &&
           (variable->n_flags == 0 || add_flags(file, dataset, variable));
}

bool netcdf_check_integers(netcdf_file *file, const char *name, int n, const double *values)
{
    for (int i = 0; i < n; i++) {
        if (!(values[i] >= INT_MIN && values[i] <= INT_MAX)) {
            if (file->reason[0] == '\0') {
                (void)snprintf(file->reason, sizeof file->reason, "%s = %g is not an integer of 32 bits", name,
                               values[i]);
            }
            return false;
        }
    }
    return true;
}

hid_t netcdf_define(netcdf_file *file, hid_t group, const netcdf_variable *variable, hsize_t chunk_rows)
{
    const hid_t dataset = create_dataset(file, group, variable, chunk_rows);
    if (dataset < 0 || !add_variable_attributes(file, dataset, variable)) {
        return H5I_INVALID_HID;
    }
    dimension_scale *scales[NETCDF_MAX_RANK];
    for (int i = 0; i < variable->rank; i++) {
        scales[i] = &variable->dimensions[i]->scale;
    }
    return scales_attach(file, dataset, variable->rank, scales) ? dataset : H5I_INVALID_HID;
}

bool netcdf_define_dimension(netcdf_file *file, hid_t group, const netcdf_variable *coordinate,
                             netcdf_dimension *dimension, hsize_t chunk_rows)
{
    netcdf_variable variable = *coordinate;
    variable.rank = 1;
    variable.dimensions[0] = dimension;
    const hid_t dataset = create_dataset(file, group, &variable, chunk_rows);
    return dataset >= 0 && (scale_make(&dimension->scale, dataset, variable.name) || netcdf_fail(file)) &&
           add_variable_attributes(file, dataset, &variable);
}

bool netcdf_write(netcdf_file *file, hid_t dataset, hid_t type, const void *values)
{
    return H5Dwrite(dataset, type, H5S_ALL, H5S_ALL, common.transfer, values) >= 0 || netcdf_fail(file);
}

bool netcdf_define_values(netcdf_file *file, hid_t group, netcdf_dimension *dimension, const netcdf_variable *variable,
                          long n, hid_t type, const void *values)
{
    *dimension = (netcdf_dimension){.length = (hsize_t)n};
    return netcdf_define_dimension(file, group, variable, dimension, 0) &&
           (n == 0 || netcdf_write(file, dimension->scale.dataset, type, values));
}

bool netcdf_define_names(netcdf_file *file, hid_t group, netcdf_dimension *dimension, const char *name,
                         const char *long_name, const name_list *names)
{
    const netcdf_variable variable = netcdf_describe(NETCDF_TEXT, name, "1", name, long_name);
    return netcdf_define_values(file, group, dimension, &variable, names->n, common.text, names->names);
}
