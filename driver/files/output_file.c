#include "files/output_file.h"

#include "base/memory.h"

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
        return "free some space or write to another place";
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
    case EWOULDBLOCK:
        return "another run is writing it: wait for it or choose another name";
    default:
        return "choose another name or place";
    }
}

bool output_file_refuse(const char *path, int system_error, const char *reason, evl_error *error)
{
    enum { REST = 240 }; /* characters that the reason and the remedy may need */
    const size_t length = strlen(path), room = sizeof error->message - REST;
    const bool is_long = length > room;
    return evl_error_set(error, EVL_EXIT_IO, "", "cannot write '%s%s': %s; %s", is_long ? "..." : "",
                         is_long ? path + (length - room) : path, reason != NULL ? reason : strerror(system_error),
                         remedy(system_error));
}

/** 0, or why a file cannot get this name: only a regular file is ever replaced. */
static int check_name(const char *path)
{
    struct stat status;
    if (stat(path, &status) != 0) {
        return 0;
    }
    return S_ISREG(status.st_mode) ? 0 : S_ISDIR(status.st_mode) ? EISDIR : EEXIST;
}

/** Folders that cannot lock (some network file systems) are no reason to refuse. */
static int take_lock(const output_file *file)
{
    struct stat opened, named;
    if (flock(file->descriptor, LOCK_EX | LOCK_NB) != 0) {
        return errno == EWOULDBLOCK ? errno : 0;
    }
    const bool is_same = fstat(file->descriptor, &opened) == 0 && stat(file->partial_path, &named) == 0 &&
                         opened.st_dev == named.st_dev && opened.st_ino == named.st_ino;
    return is_same ? 0 : EWOULDBLOCK; /* another run has just renamed it */
}

bool output_file_open(output_file *file, const char *path, evl_error *error)
{
    *file = (output_file){.path = xstrdup(path), .partial_path = xasprintf("%s.partial", path), .descriptor = -1};
    int reason = check_name(path);
    const char *about = path;
    if (reason == 0) {
        about = file->partial_path;
        reason = check_name(about);
    }
    if (reason == 0) {
        file->descriptor = open(file->partial_path, O_RDWR | O_CREAT | O_CLOEXEC, 0666);
        reason = file->descriptor < 0 ? errno : take_lock(file);
    }
    if (reason != 0) {
        output_file_refuse(about, reason, reason == EEXIST ? "not a regular file" : NULL, error);
        output_file_drop(file, false);
    }
    return reason == 0;
}

/** A rename is safe on disk only when its folder is. Not all file systems can do that, and the file itself is safe. */
static void sync_folder(const char *path)
{
    OWNED char *folder = xstrdup(path);
    char *slash = strrchr(folder, '/');
    if (slash != NULL) {
        slash[slash == folder ? 1 : 0] = '\0';
    }
    const int descriptor = open(slash != NULL ? folder : ".", O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (descriptor >= 0) {
        (void)fsync(descriptor);
        (void)close(descriptor);
    }
}

bool output_file_close(output_file *file, bool commit, evl_error *error)
{
    bool good =
        fsync(file->descriptor) == 0 || errno == EINVAL || output_file_refuse(file->partial_path, errno, NULL, error);
    if (good && commit) {
        good = rename(file->partial_path, file->path) == 0 || output_file_refuse(file->path, errno, NULL, error);
    }
    if (good && commit) {
        sync_folder(file->path);
    }
    output_file_drop(file, false);
    return good;
}

void output_file_drop(output_file *file, bool remove)
{
    if (remove) {
        (void)unlink(file->partial_path);
    }
    if (file->descriptor >= 0) {
        (void)close(file->descriptor);
    }
    free(file->path);
    free(file->partial_path);
    *file = (output_file){.descriptor = -1};
}
