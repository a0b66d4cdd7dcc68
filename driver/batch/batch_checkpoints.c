#include "batch/batch_checkpoints.h"

#include "base/memory.h"
#include "base/number.h"
#include "base/write_bytes.h"
#include "files/checkpoint.h"

#include <dirent.h>
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

static const double usual = 600; /* s */

bool batch_checkpoints_read(const char *minutes, double *interval)
{
    double number = 0;
    *interval = usual;
    if (minutes == NULL) {
        return true;
    }
    const bool good = number_read(minutes, &number) == NUMBER_FINITE && number >= 0;
    *interval = number > 0 ? 60 * number : INFINITY;
    return good;
}

char *batch_checkpoints_path(const batch_checkpoints *self, long index)
{
    return xasprintf("%s/%ld", self->folder, index);
}

bool batch_checkpoints_has(const batch_checkpoints *self, long index)
{
    if (access(self->folder, F_OK) != 0) { /* repeated calls are cached even by remote file systems */
        return false;
    }
    CLEANUP_FREE char *path = batch_checkpoints_path(self, index);
    return checkpoint_exists(path);
}

double batch_checkpoints_reach(const batch_checkpoints *self, long index)
{
    char doubt[EVL_ERROR_MESSAGE_LENGTH];
    evl_error why = {.code = EVL_EXIT_OK};
    checkpoint found = {.t = 0};
    CLEANUP_FREE char *path = batch_checkpoints_path(self, index);
    const bool is_there = batch_checkpoints_has(self, index) && checkpoint_read(path, &found, doubt, &why);
    const double t = is_there ? found.t : -INFINITY;
    checkpoint_free(&found);
    return t;
}

/** @return false with the reason in errno */
static bool make_folder(const char *path)
{
    struct stat status;
    bool good = mkdir(path, 0777) == 0;
    if (!good && errno == EEXIST && lstat(path, &status) == 0) {
        good = S_ISDIR(status.st_mode);
        errno = ENOTDIR;
    }
    return good;
}

bool batch_checkpoints_make(const batch_checkpoints *self, long index, evl_error *error)
{
    enum { MOST = 1000 };
    CLEANUP_FREE char *path = batch_checkpoints_path(self, index);
    const char *failed = self->folder;
    bool good = false;
    for (int attempt = 0; attempt < MOST && !good; attempt++) {
        const bool has_common = make_folder(self->folder);
        good = has_common && make_folder(path);
        failed = has_common ? path : self->folder;
        if (!good &&
            errno != ENOENT) { /* otherwise the supervisor has just removed the common folder, which was empty */
            break;
        }
    }
    return (good && sync_name(self->folder) && sync_name(path)) || evl_error_set_unwritten(error, failed);
}

void batch_checkpoints_remove(const batch_checkpoints *self, long index)
{
    CLEANUP_FREE char *path = batch_checkpoints_path(self, index);
    (void)checkpoint_remove(path);
    (void)rmdir(path);
    (void)rmdir(self->folder); /* if this was the last one */
}

static int compare(const void *a, const void *b)
{
    const long first = *(const long *)a, second = *(const long *)b;
    return (first > second) - (first < second);
}

/** Case number given by a name; -1: not a case folder. */
static long number_of(const char *name)
{
    char *end = NULL;
    const long number = strtol(name, &end, 10);
    return name[0] >= '0' && name[0] <= '9' && *end == '\0' ? number : -1;
}

void batch_checkpoints_retain(const batch_checkpoints *self, long n, const long *todo)
{
    DIR *folder = opendir(self->folder);
    if (folder == NULL) {
        return;
    }
    for (const struct dirent *entry = readdir(folder); entry != NULL; entry = readdir(folder)) {
        const long index = number_of(entry->d_name);
        if (index >= 0 && (n == 0 || bsearch(&index, todo, (size_t)n, sizeof index, compare) == NULL)) {
            batch_checkpoints_remove(self, index);
        }
    }
    (void)closedir(folder);
    (void)rmdir(self->folder);
}
