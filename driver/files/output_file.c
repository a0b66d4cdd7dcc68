#include "files/output_file.h"

#include "base/memory.h"
#include "base/write_bytes.h"
#include "files/checksum.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

static const char *remedy(int system_error)
{
    switch (system_error) {
    case ENOSPC:
    case EDQUOT:
        return "free some space or write to another folder";
    case EFBIG:
        return "raise the limit of file sizes (ulimit -f) or write fewer outputs";
    case ENOENT:
    case ENOTDIR:
        return "create the folder first or write to another one";
    case EACCES:
    case EPERM:
    case EROFS:
        return "write to a folder where you may create files";
    case EISDIR:
        return "name a file";
    case ELOOP:
        return "remove it or choose another name";
    case EWOULDBLOCK:
        return "another run is writing it; wait until it ends, or choose another name";
    default:
        return "choose another name or folder";
    }
}

bool output_file_refuse(const char *path, int system_error, const char *reason, evl_error *error)
{
    enum { REST = 240 }; /* characters reserved for the reason and the remedy */
    const size_t length = strlen(path), available = sizeof error->message - REST;
    const bool is_long = length > available;
    return evl_error_set(error, EVL_EXIT_IO, "", "cannot write '%s%s': %s; %s", is_long ? "..." : "",
                         is_long ? path + (length - available) : path, reason != NULL ? reason : strerror(system_error),
                         remedy(system_error));
}

/** 0, or the reason why a file cannot be renamed to this path: only a regular file is ever replaced.
 *  @param is_derived  the name was not chosen by the user: a link of that name would lead to an unintended file */
static int check_name(const char *path, bool is_derived)
{
    struct stat status;
    if ((is_derived ? lstat(path, &status) : stat(path, &status)) != 0) {
        return 0;
    }
    if (is_derived && S_ISLNK(status.st_mode)) {
        return ELOOP;
    }
    return S_ISREG(status.st_mode) ? 0 : S_ISDIR(status.st_mode) ? EISDIR : EEXIST;
}

/** Folders that do not support locks (some network file systems) are accepted. */
static int lock(int descriptor)
{
    return flock(descriptor, LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK ? 0 : errno;
}

/** Whether the open file still is NAME.partial: another run may just have renamed it. */
static bool has_name(const output_file *file)
{
    struct stat opened, named;
    return fstat(file->descriptor, &opened) == 0 && stat(file->partial_path, &named) == 0 &&
           opened.st_dev == named.st_dev && opened.st_ino == named.st_ino;
}

/** 0, or the reason why this run may not write to the open NAME.partial. */
static int take_lock(const output_file *file)
{
    const int reason = lock(file->descriptor);
    return reason != 0 ? reason : has_name(file) ? 0 : EWOULDBLOCK;
}

bool output_file_open(output_file *file, const char *path, evl_error *error)
{
    *file = (output_file){.path = xstrdup(path),
                          .partial_path = xasprintf("%s.partial", path),
                          .fresh_path = xasprintf("%s.partial.new", path),
                          .descriptor = -1,
                          .fresh_descriptor = -1};
    int reason = check_name(path, false);
    const char *about = path;
    if (reason == 0) {
        about = file->partial_path;
        reason = check_name(about, true);
    }
    if (reason == 0) {
        file->descriptor = open(file->partial_path, O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0666);
        reason = file->descriptor < 0 ? errno : take_lock(file);
    }
    if (reason == 0 && ftruncate(file->descriptor, 0) != 0) { /* discard the content of an earlier run */
        reason = errno;
    }
    if (reason != 0) {
        output_file_refuse(about, reason,
                           reason == EEXIST  ? "not a regular file"
                           : reason == ELOOP ? "a symbolic link, which is not followed"
                                             : NULL,
                           error);
        output_file_drop(file, false);
    }
    return reason == 0;
}

int output_file_begin_fresh(output_file *file)
{
    (void)unlink(file->fresh_path); /* left by a run that was killed */
    file->fresh_descriptor = open(file->fresh_path, O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    return file->fresh_descriptor < 0 ? errno : lock(file->fresh_descriptor);
}

int output_file_hide(output_file *file)
{
    if (!has_name(file)) {
        return EWOULDBLOCK;
    }
    file->is_hidden = rename(file->partial_path, file->fresh_path) == 0;
    return file->is_hidden ? 0 : errno;
}

int output_file_show(output_file *file)
{
    if (rename(file->fresh_path, file->partial_path) != 0) {
        return errno;
    }
    file->is_hidden = false;
    if (file->fresh_descriptor >= 0) {
        (void)close(file->descriptor);
        file->descriptor = file->fresh_descriptor;
        file->fresh_descriptor = -1;
    }
    return 0;
}

bool output_file_close(output_file *file, bool commit, evl_error *error)
{
    bool good = !commit || file->is_open_end || checksum_append(file->descriptor) ||
                output_file_refuse(file->partial_path, errno, NULL, error);
    good = good && (sync_bytes(file->descriptor) || output_file_refuse(file->partial_path, errno, NULL, error));
    if (good && commit) {
        good = has_name(file) || output_file_refuse(file->partial_path, EWOULDBLOCK, NULL, error);
    }
    if (good && commit) {
        good = rename(file->partial_path, file->path) == 0 || output_file_refuse(file->path, errno, NULL, error);
    }
    if (good && commit) { /* a rename is safe on disk only after its folder is synchronised */
        good = sync_name(file->path) || output_file_refuse(file->path, errno, NULL, error);
    }
    output_file_drop(file, false);
    return good;
}

void output_file_drop(output_file *file, bool remove)
{
    if (file->is_hidden) { /* it may be readable */
        (void)rename(file->fresh_path, file->partial_path);
    }
    if (remove) {
        (void)unlink(file->partial_path);
    }
    if (file->descriptor >= 0) {
        (void)close(file->descriptor);
    }
    if (file->fresh_descriptor >= 0) {
        (void)unlink(file->fresh_path);
        (void)close(file->fresh_descriptor);
    }
    free(file->path);
    free(file->partial_path);
    free(file->fresh_path);
    *file = (output_file){.descriptor = -1, .fresh_descriptor = -1};
}
