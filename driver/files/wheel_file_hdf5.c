#include "files/wheel_file.h"

#include "base/memory.h"
#include "base/write_bytes.h"
#include "files/checksum.h"
#include "files/netcdf_hdf5.h"

#include <errno.h>
#include <evolvent_version.h>
#include <hdf5.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { FORMAT = 1 };

/* ---- identification of a file ---- */

/** FNV-1a over the bits of numbers. */
unsigned long long wheel_file_hash(const wheel_numbers *wheel)
{
    unsigned long long hash = 0xcbf29ce484222325ULL;
    const unsigned char *bytes = (const unsigned char *)wheel->key;
    for (size_t i = 0; i < (size_t)wheel->n_key * sizeof *wheel->key; i++) {
        hash = (hash ^ bytes[i]) * 0x100000001b3ULL;
    }
    return hash;
}

/* ---- writing ---- */

static bool put_numbers(netcdf_file *file, const char *name, int n, const double *numbers)
{
    const hsize_t length = (hsize_t)n;
    CLOSED const hid_t space = H5Screate_simple(1, &length, NULL);
    CLOSED const hid_t dataset =
        space < 0 ? H5I_INVALID_HID
                  : H5Dcreate2(file->id, name, H5T_NATIVE_DOUBLE, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    return (dataset >= 0 && H5Dwrite(dataset, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, numbers) >= 0) ||
           netcdf_fail(file);
}

static bool fill_file(netcdf_file *file, const wheel_numbers *wheel)
{
    return netcdf_put_integer(file, file->id, "evolvent_wheel_format", FORMAT) &&
           netcdf_put_text(file, file->id, "evolvent_version", EVOLVENT_VERSION) &&
           put_numbers(file, "key", wheel->n_key, wheel->key) && put_numbers(file, "numbers", wheel->n, wheel->numbers);
}

/** Give the file the same permissions as other new files in the folder. */
static bool open_to_others(int descriptor)
{
    const mode_t mask = umask(0);
    (void)umask(mask);
    return fchmod(descriptor, 0666 & ~mask) == 0;
}

/** Write the file under a temporary name. */
static bool write_partial(const char *partial, int descriptor, const wheel_numbers *wheel, const char *path,
                          evl_error *error)
{
    netcdf_file file = {0};
    bool good = netcdf_create(&file, partial) && fill_file(&file, wheel);
    good = netcdf_close(&file) && good;
    if (!good) {
        return evl_error_set(error, EVL_EXIT_IO, path, "cannot be written: %s; free space, then continue with --resume",
                             file.reason);
    }
    return (checksum_append(descriptor) && open_to_others(descriptor) && sync_bytes(descriptor)) ||
           evl_error_set_unwritten(error, path);
}

/** Rename a file unless one of that name exists. On a file system without links, the later of two simultaneous files
 *  remains: both are complete. */
static bool name_file(const char *partial, const char *path, evl_error *error)
{
    return link(partial, path) == 0 || errno == EEXIST || access(path, F_OK) == 0 || rename(partial, path) == 0 ||
           evl_error_set_unwritten(error, path);
}

bool wheel_file_write(const char *path, const wheel_numbers *wheel, evl_error *error)
{
    CLEANUP_FREE char *partial = xasprintf("%s.XXXXXX", path);
    const int descriptor = mkstemp(partial);
    if (descriptor < 0) {
        return evl_error_set_unwritten(error, path);
    }
    const bool good = write_partial(partial, descriptor, wheel, path, error) && name_file(partial, path, error);
    (void)unlink(partial);
    (void)close(descriptor);
    return good;
}

/* ---- reading ---- */

static bool has_integer(hid_t file, const char *name, long long expected)
{
    long long value = 0;
    return netcdf_get_numbers(file, name, H5T_NATIVE_LLONG, 1, &value) && value == expected;
}

static bool get_numbers(hid_t file, const char *name, int n, double *numbers)
{
    CLOSED const hid_t dataset = H5Lexists(file, name, H5P_DEFAULT) > 0 ? H5Dopen2(file, name, H5P_DEFAULT) : -1;
    CLOSED const hid_t space = dataset < 0 ? -1 : H5Dget_space(dataset);
    return space >= 0 && H5Sget_simple_extent_npoints(space) == n &&
           H5Dread(dataset, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, numbers) >= 0;
}

/** NULL, or the fault. */
static const char *find_fault(hid_t file, const wheel_numbers *wheel)
{
    CLEANUP_FREE double *key = xcalloc((size_t)wheel->n_key, sizeof *key);
    if (!has_integer(file, "evolvent_wheel_format", FORMAT)) {
        return "is not a compliance of a wheel";
    }
    if (!get_numbers(file, "key", wheel->n_key, key) || !get_numbers(file, "numbers", wheel->n, wheel->numbers)) {
        return "has the wrong number of values for the compliance of a wheel";
    }
    return memcmp(key, wheel->key, (size_t)wheel->n_key * sizeof *key) == 0 ? NULL : "belongs to another wheel";
}

wheel_file_status wheel_file_read(const char *path, const wheel_numbers *wheel, evl_error *error)
{
    if (access(path, F_OK) != 0) {
        return WHEEL_FILE_MISSING;
    }
    const checksum_status checksum = checksum_verify(path); /* the library does not detect damage */
    if (checksum == CHECKSUM_UNREADABLE) {
        evl_error_set(error, EVL_EXIT_CASE, path, "cannot be read: %s; continue with --resume", strerror(errno));
        return WHEEL_FILE_REFUSED;
    }
    CLOSED const hid_t file = checksum == CHECKSUM_CORRECT ? netcdf_open(path) : -1;
    const char *fault = checksum != CHECKSUM_CORRECT ? "is damaged: its checksum is wrong"
                        : file < 0                   ? netcdf_system_reason("cannot be read")
                                                     : find_fault(file, wheel);
    if (fault == NULL) {
        return WHEEL_FILE_READ;
    }
    evl_error_set(error, EVL_EXIT_CASE, path, "%s; delete it and continue with --resume; it is computed again", fault);
    return WHEEL_FILE_REFUSED;
}
