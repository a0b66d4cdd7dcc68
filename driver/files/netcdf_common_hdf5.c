#include "files/netcdf_common_hdf5.h"

#include "base/memory.h"

#include <math.h>
#include <stdlib.h>

netcdf_common netcdf_cached;

/* Bytes that the library allocates for a file and some variables; it may crash if an allocation fails. */
enum { NEEDED = 24 * 1024 * 1024 };

/* After a failed write the library cannot clean up at exit and would crash. Its own lock would conflict with the
 * caller's, who locks the file before it is emptied. */
void netcdf_prepare_library(void)
{
    (void)H5dont_atexit();
    static const char locking[] = "HDF5_USE_FILE_LOCKING";
    if (setenv(locking, "FALSE", 1) != 0) {
        evl_memory_run_out(1, sizeof locking); /* HDF5's own locks would conflict with ours */
    }
    memory_need(NEEDED);
}

/** Reproducible files: members in order of creation, as required by netCDF, and no times. */
static bool set_group_properties(hid_t properties)
{
    const unsigned order = H5P_CRT_ORDER_TRACKED | H5P_CRT_ORDER_INDEXED;
    return H5Pset_link_creation_order(properties, order) >= 0 && H5Pset_obj_track_times(properties, 0) >= 0;
}

/** Metadata of variables stay in memory between flushes. Evicted metadata would not match the rest of the file, so that
 *  the file of a killed run could not be read. Rows are not affected. */
static bool hold_metadata(hid_t access)
{
    H5AC_cache_config_t config = {.version = H5AC__CURR_CACHE_CONFIG_VERSION};
    if (H5Pget_mdc_config(access, &config) < 0) {
        return false;
    }
    config.evictions_enabled = false;
    config.incr_mode = H5C_incr__off;
    config.flash_incr_mode = H5C_flash_incr__off;
    config.decr_mode = H5C_decr__off;
    return H5Pset_mdc_config(access, &config) >= 0;
}

static bool prepare_files(void)
{
    netcdf_common *cached = &netcdf_cached;
    cached->file_access = H5Pcreate(H5P_FILE_ACCESS);
    cached->file_create = H5Pcreate(H5P_FILE_CREATE);
    cached->group_create = H5Pcreate(H5P_GROUP_CREATE);
    /* Format 1.8: later ones mark a file as open for writing, and a killed run's flushed file could not be read. The
     * same applies to single writer, multiple readers (SWMR): the file can be opened only in that mode until the mark
     * is cleared, and the lengths of variables differ. A sieve buffer would take 64 kilobytes, zeroed, for each
     * variable, which is written at once. */
    return cached->file_access >= 0 && cached->file_create >= 0 && cached->group_create >= 0 &&
           H5Pset_libver_bounds(cached->file_access, H5F_LIBVER_V18, H5F_LIBVER_V18) >= 0 &&
           H5Pset_fclose_degree(cached->file_access, H5F_CLOSE_STRONG) >= 0 &&
           H5Pset_sieve_buf_size(cached->file_access, 1) >= 0 && hold_metadata(cached->file_access) &&
           set_group_properties(cached->file_create) && set_group_properties(cached->group_create);
}

/** Storage of variables; a growing one gets its chunks when it is created. */
static bool prepare_stores(void)
{
    const double missing = NAN;
    netcdf_common *cached = &netcdf_cached;
    /* Rows are written in order, many at a time: a cache would only cost memory, a megabyte per variable, and filling
     * in advance would only cost an additional copy. */
    cached->access = H5Pcreate(H5P_DATASET_ACCESS);
    bool good = cached->access >= 0 && H5Pset_chunk_cache(cached->access, 1, 0, 1.0) >= 0;
    for (int store = 0; store < N_STORES; store++) {
        for (int is_real = 0; is_real < 2; is_real++) {
            const hid_t creation = cached->creation[store][is_real] = H5Pcreate(H5P_DATASET_CREATE);
            good = good && creation >= 0 && H5Pset_obj_track_times(creation, 0) >= 0 &&
                   (store != STORE_COMPACT || H5Pset_layout(creation, H5D_COMPACT) >= 0) &&
                   (store != STORE_GROWING || H5Pset_fill_time(creation, H5D_FILL_TIME_NEVER) >= 0) &&
                   (!is_real || H5Pset_fill_value(creation, H5T_NATIVE_DOUBLE, &missing) >= 0);
        }
    }
    return good;
}

static bool prepare_types(void)
{
    const hsize_t one = 1;
    netcdf_common *cached = &netcdf_cached;
    cached->text = H5Tcopy(H5T_C_S1);
    cached->references = H5Tvlen_create(H5T_STD_REF_OBJ);
    cached->users = H5Tcreate(H5T_COMPOUND, sizeof(scale_user));
    cached->scalar = H5Screate(H5S_SCALAR);
    cached->one = H5Screate_simple(1, &one, NULL);
    cached->transfer = H5Pcreate(H5P_DATASET_XFER);
    return cached->text >= 0 && cached->references >= 0 && cached->users >= 0 && cached->scalar >= 0 &&
           cached->one >= 0 && cached->transfer >= 0 && H5Pset_buffer(cached->transfer, 16 * 1024, NULL, NULL) >= 0 &&
           H5Tset_size(cached->text, H5T_VARIABLE) >= 0 && H5Tset_cset(cached->text, H5T_CSET_UTF8) >= 0 &&
           H5Tinsert(cached->users, "dataset", HOFFSET(scale_user, dataset), H5T_STD_REF_OBJ) >= 0 &&
           H5Tinsert(cached->users, "dimension", HOFFSET(scale_user, axis), H5T_NATIVE_INT) >= 0;
}

bool netcdf_prepare(void)
{
    const int bytes = 64 * 1024; /* limit of each free list of the library */
    if (netcdf_cached.is_ready) {
        return true;
    }
    netcdf_prepare_library();
    netcdf_cached.is_ready = H5open() >= 0 && H5Eset_auto2(H5E_DEFAULT, NULL, NULL) >= 0 &&
                             H5set_free_list_limits(bytes, bytes, bytes, bytes, bytes, bytes) >= 0 && prepare_types() &&
                             prepare_files() && prepare_stores();
    return netcdf_cached.is_ready;
}
