#include "files/parts.h"

#include "base/memory.h"
#include "base/write_bytes.h"
#include "files/checkpoint.h"
#include "files/output_file.h"

#include <dirent.h>
#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

char *parts_folder(const char *path)
{
    return xasprintf("%s.parts", path);
}

bool parts_open(parts *parts, const char *path, evl_error *error)
{
    *parts = (struct parts){.folder = parts_folder(path), .lock = {-1}};
    CLEANUP_FREE char *lock = xasprintf("%s/lock", parts->folder);
    if ((mkdir(parts->folder, 0777) != 0 && errno != EEXIST) || !sync_name(parts->folder)) {
        return output_file_refuse(parts->folder, errno, NULL, error);
    }
    return file_lock_take(&parts->lock, lock, error);
}

void parts_close(parts *parts)
{
    file_lock_release(&parts->lock);
    free(parts->folder);
    parts->folder = NULL;
}

char *parts_path(const parts *parts, int index)
{
    return xasprintf("%s/part-%04d.h5", parts->folder, index);
}

/** Number of the part in a complete or partial file; 0: it is not a part. *is_complete: it has its final name */
static int number_of(const char *name, bool *is_complete)
{
    static const char prefix[] = "part-", suffix[] = ".h5";
    char *end = NULL;
    if (strncmp(name, prefix, sizeof prefix - 1) != 0 || name[sizeof prefix - 1] < '0' ||
        name[sizeof prefix - 1] > '9') {
        return 0;
    }
    const long number = strtol(name + sizeof prefix - 1, &end, 10);
    *is_complete = strcmp(end, suffix) == 0;
    return strncmp(end, suffix, sizeof suffix - 1) == 0 && number > 0 && number < INT_MAX ? (int)number : 0;
}

bool parts_retain(parts *parts, int n, evl_error *error)
{
    DIR *folder = opendir(parts->folder);
    bool good = folder != NULL;
    int reason = errno;
    for (const struct dirent *entry = good ? readdir(folder) : NULL; entry != NULL && good; entry = readdir(folder)) {
        bool is_complete = false;
        const int number = number_of(entry->d_name, &is_complete);
        if (number > n || (number > 0 && !is_complete)) {
            CLEANUP_FREE char *path = xasprintf("%s/%s", parts->folder, entry->d_name);
            good = unlink(path) == 0;
            reason = errno;
        }
    }
    (void)(folder != NULL && closedir(folder));
    parts->n = n;
    return good || output_file_refuse(parts->folder, reason, NULL, error);
}

void parts_remove(parts *parts)
{
    evl_error error = {.code = EVL_EXIT_OK};
    CLEANUP_FREE char *lock = xasprintf("%s/lock", parts->folder);
    if (checkpoint_remove(parts->folder) && parts_retain(parts, 0, &error)) {
        (void)unlink(lock);
        (void)rmdir(parts->folder);
        (void)sync_name(parts->folder); /* if lost in a power failure, the rest is removed next time */
    }
}
