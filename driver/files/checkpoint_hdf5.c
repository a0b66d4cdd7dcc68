#include "files/checkpoint.h"

#include "base/memory.h"
#include "base/write_bytes.h"
#include "files/netcdf_hdf5.h"
#include "files/output_file.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* HDF5 reserves this many bytes at the start of a file as user block: the smallest possible size. */
enum { BLOCK = 512, IMAGE_STEP = 1 << 20 };
static const char block_format[] = "evolvent checkpoint 1, FNV-1a %016" PRIx64 " of the %zu bytes behind byte 512\n";

static const char *const names[] = {"checkpoint.h5", "checkpoint-before.h5"}; /* the newer one, the older one */
static const char partial[] = "checkpoint.h5.partial";
static const char *const text_names[N_CHECKPOINT_TEXTS] = {"program", "integrator", "kernel", "case"};

static uint64_t check_sum(size_t n, const unsigned char *bytes)
{
    uint64_t sum = 0xcbf29ce484222325U;
    for (size_t i = 0; i < n; i++) {
        sum = (sum ^ bytes[i]) * 0x100000001b3U;
    }
    return sum;
}

/* ---- in memory: a file of HDF5 ---- */

static bool put(netcdf_file *file, const char *name, size_t n, const void *bytes)
{
    const hsize_t length = n;
    CLOSED const hid_t space = H5Screate_simple(1, &length, NULL);
    CLOSED const hid_t dataset =
        space < 0 ? space : H5Dcreate2(file->id, name, H5T_NATIVE_UCHAR, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    return (dataset >= 0 && H5Dwrite(dataset, H5T_NATIVE_UCHAR, H5S_ALL, H5S_ALL, H5P_DEFAULT, bytes) >= 0) ||
           netcdf_fail(file);
}

static bool fill(netcdf_file *file, const checkpoint *from)
{
    bool good = put(file, "time", sizeof from->t, &from->t) && put(file, "state", from->state.n, from->state.bytes);
    for (int i = 0; i < N_CHECKPOINT_TEXTS && good; i++) {
        good = put(file, text_names[i], strlen(from->texts[i]) + 1, from->texts[i]);
    }
    return good && netcdf_flush(file);
}

/** Properties of a file in memory only. @param image  NULL: a new one */
static hid_t in_memory(size_t n, void *image)
{
    const hid_t access = H5Pcreate(H5P_FILE_ACCESS);
    const bool good = access >= 0 && H5Pset_fapl_core(access, IMAGE_STEP, false) >= 0 &&
                      (image == NULL || H5Pset_file_image(access, image, n) >= 0);
    return good ? access : H5I_INVALID_HID;
}

/** All bytes of a checkpoint file, with the checksum in front. @return NULL with the reason in the netcdf_file */
static unsigned char *make_image(netcdf_file *file, const checkpoint *from, size_t *n)
{
    unsigned version[3];
    netcdf_library_version(version); /* also initialises the library */
    (void)H5Eset_auto2(H5E_DEFAULT, NULL, NULL);
    CLOSED const hid_t access = in_memory(0, NULL), creation = H5Pcreate(H5P_FILE_CREATE);
    if (access < 0 || creation < 0 || H5Pset_userblock(creation, BLOCK) < 0) {
        (void)netcdf_fail(file);
        return NULL;
    }
    file->id = H5Fcreate(names[0], H5F_ACC_TRUNC, creation, access);
    if (file->id < 0 || !fill(file, from)) {
        (void)netcdf_fail(file);
        return NULL;
    }
    const ssize_t size = H5Fget_file_image(file->id, NULL, 0); /* without the user block */
    *n = BLOCK + (size > 0 ? (size_t)size : 0);
    unsigned char *image = xcalloc(*n, 1);
    if (size <= 0 || H5Fget_file_image(file->id, image + BLOCK, (size_t)size) != size) {
        (void)netcdf_fail(file);
        free(image);
        return NULL;
    }
    (void)snprintf((char *)image, BLOCK, block_format, check_sum(*n - BLOCK, image + BLOCK), *n - BLOCK);
    return image;
}

/** Read an array of bytes with a terminating zero: a new one. NULL if it does not exist. */
static unsigned char *get(hid_t file, const char *name, size_t *n)
{
    CLOSED const hid_t dataset = H5Dopen2(file, name, H5P_DEFAULT);
    CLOSED const hid_t space = dataset < 0 ? dataset : H5Dget_space(dataset);
    const hssize_t length = space < 0 ? -1 : H5Sget_simple_extent_npoints(space);
    if (length < 0) {
        return NULL;
    }
    unsigned char *bytes = xcalloc((size_t)length + 1, 1);
    *n = (size_t)length;
    if (H5Dread(dataset, H5T_NATIVE_UCHAR, H5S_ALL, H5S_ALL, H5P_DEFAULT, bytes) < 0) {
        free(bytes);
        bytes = NULL;
    }
    return bytes;
}

static bool take_image(size_t n, void *image, checkpoint *to)
{
    unsigned version[3];
    netcdf_library_version(version);
    (void)H5Eset_auto2(H5E_DEFAULT, NULL, NULL);
    CLOSED const hid_t access = in_memory(n, image);
    const hid_t file = access < 0 ? access : H5Fopen(names[0], H5F_ACC_RDONLY, access);
    size_t length = 0;
    CLEANUP_FREE unsigned char *time = file < 0 ? NULL : get(file, "time", &length);
    bool good = time != NULL && length == sizeof to->t;
    if (good) {
        memcpy(&to->t, time, sizeof to->t);
        to->state = (archive){.is_reading = true};
        to->state.bytes = get(file, "state", &to->state.n);
        good = to->state.bytes != NULL;
    }
    for (int i = 0; i < N_CHECKPOINT_TEXTS && good; i++) {
        to->texts[i] = (char *)get(file, text_names[i], &length);
        good = to->texts[i] != NULL;
    }
    (void)(file >= 0 && H5Fclose(file));
    return good;
}

/* ---- on disk ---- */

static bool write_image(const char *path, size_t n, const unsigned char *image, evl_error *error)
{
    const int descriptor = open(path, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC | O_NOFOLLOW, 0666);
    bool good = descriptor >= 0 && write_bytes(descriptor, 0, image, n) == n && sync_bytes(descriptor);
    int reason = errno;
    if (descriptor >= 0 && close(descriptor) != 0 && good) {
        good = false;
        reason = errno;
    }
    return good || output_file_refuse(path, reason, NULL, error);
}

/** The newer checkpoint becomes the older one, which is deleted. There is a newer one at any time, except on a file
 *  system without links. */
static bool name_image(const char *folder, const char *path, evl_error *error)
{
    CLEANUP_FREE char *newer = xasprintf("%s/%s", folder, names[0]), *older = xasprintf("%s/%s", folder, names[1]);
    (void)unlink(older);
    const bool is_safe = link(newer, older) == 0 || errno == ENOENT || rename(newer, older) == 0 || errno == ENOENT;
    return (is_safe && rename(path, newer) == 0 && sync_name(newer)) || output_file_refuse(newer, errno, NULL, error);
}

bool checkpoint_write(const char *folder, const checkpoint *checkpoint, evl_error *error)
{
    netcdf_file file = {.id = H5I_INVALID_HID};
    size_t n = 0;
    CLEANUP_FREE char *path = xasprintf("%s/%s", folder, partial);
    CLEANUP_FREE unsigned char *image = make_image(&file, checkpoint, &n);
    if (file.id >= 0) {
        (void)netcdf_close(&file);
    }
    if (image == NULL) {
        return output_file_refuse(path, file.system_error, file.reason, error);
    }
    const bool good = write_image(path, n, image, error) && name_image(folder, path, error);
    if (!good) {
        (void)unlink(path);
    }
    return good;
}

/** Read all bytes of a file: a new array, or NULL with the system error. */
static unsigned char *read_file(const char *path, size_t *n, int *reason)
{
    struct stat status = {0};
    const int descriptor = open(path, O_RDONLY | O_CLOEXEC);
    ssize_t more = descriptor >= 0 && fstat(descriptor, &status) == 0 ? 1 : -1;
    unsigned char *bytes = xcalloc((size_t)status.st_size + 1, 1);
    for (*n = 0; more > 0 && *n < (size_t)status.st_size; *n += more > 0 ? (size_t)more : 0) {
        more = read(descriptor, bytes + *n, (size_t)status.st_size - *n);
    }
    *reason = more < 0 ? errno : 0;
    (void)(descriptor >= 0 && close(descriptor));
    if (more < 0) {
        free(bytes);
        bytes = NULL;
    }
    return bytes;
}

static bool has_its_check(size_t n, const unsigned char *image)
{
    unsigned char block[BLOCK] = {0};
    if (n <= BLOCK) {
        return false;
    }
    (void)snprintf((char *)block, sizeof block, block_format, check_sum(n - BLOCK, image + BLOCK), n - BLOCK);
    return memcmp(block, image, BLOCK) == 0;
}

/** @return false with the fault in a new string, NULL if there is no such file */
static bool read_one(const char *path, checkpoint *to, char **wrong)
{
    size_t n = 0;
    int reason = 0;
    CLEANUP_FREE unsigned char *image = read_file(path, &n, &reason);
    *wrong = NULL;
    if (image == NULL) {
        *wrong = reason == ENOENT ? NULL : xasprintf("'%s' cannot be read: %s", path, strerror(reason));
    } else if (!has_its_check(n, image) || !take_image(n, image, to)) {
        *wrong = xasprintf("'%s' is damaged, or is not a checkpoint", path);
    } else {
        return true;
    }
    return false;
}

bool checkpoint_read(const char *folder, checkpoint *checkpoint, char *doubt, evl_error *error)
{
    CLEANUP_FREE char *newer = xasprintf("%s/%s", folder, names[0]), *older = xasprintf("%s/%s", folder, names[1]);
    CLEANUP_FREE char *wrong = NULL, *wrong_before = NULL;
    *checkpoint = (struct checkpoint){.t = 0};
    doubt[0] = '\0';
    if (read_one(newer, checkpoint, &wrong)) {
        return true;
    }
    checkpoint_free(checkpoint);
    if (read_one(older, checkpoint, &wrong_before)) {
        (void)rename(older, newer);
        (void)snprintf(doubt, EVL_ERROR_MESSAGE_LENGTH, "%s", wrong != NULL ? wrong : "");
        return true;
    }
    const char *why = wrong != NULL ? wrong : wrong_before;
    return why != NULL ? evl_error_set(error, EVL_EXIT_CASE, "", "%s", why)
                       : evl_error_set(error, EVL_EXIT_CASE, "", "there is no checkpoint in '%s'", folder);
}

bool checkpoint_exists(const char *folder)
{
    bool any = false;
    for (int i = 0; i < 2; i++) {
        CLEANUP_FREE char *path = xasprintf("%s/%s", folder, names[i]);
        any = any || access(path, F_OK) == 0;
    }
    return any;
}

bool checkpoint_remove(const char *folder)
{
    const char *const all[] = {partial, names[1], names[0]};
    bool good = true;
    for (int i = 0; i < 3; i++) {
        CLEANUP_FREE char *path = xasprintf("%s/%s", folder, all[i]);
        good = (unlink(path) == 0 || errno == ENOENT) && good;
    }
    return good;
}

void checkpoint_free(checkpoint *checkpoint)
{
    archive_free(&checkpoint->state);
    for (int i = 0; i < N_CHECKPOINT_TEXTS; i++) {
        free(checkpoint->texts[i]);
    }
    *checkpoint = (struct checkpoint){.t = 0};
}
