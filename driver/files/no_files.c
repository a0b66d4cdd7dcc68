/* The library has no files: nothing remains after a call, a computation cannot be resumed, and wheels are cached during
 * one call only. These are the functions of parts.h, checkpoint.h and wheel_file.h that analyses in memory need. */
#include "base/memory.h"
#include "files/checkpoint.h"
#include "files/parts.h"
#include "files/wheel_file.h"

#include <stdlib.h>

bool parts_open(parts *parts, const char *path, evl_error *error)
{
    (void)path;
    (void)error;
    *parts = (struct parts){.folder = xstrdup(""), .lock = {-1}};
    return true;
}

void parts_close(parts *parts)
{
    free(parts->folder);
    parts->folder = NULL;
}

void parts_remove(parts *parts)
{
    (void)parts;
}

bool checkpoint_exists(const char *folder)
{
    (void)folder;
    return false;
}

bool checkpoint_read(const char *folder, checkpoint *checkpoint, char *doubt, evl_error *error)
{
    doubt[0] = '\0';
    checkpoint->state = (archive){.n = 0};
    return evl_error_set(error, EVL_EXIT_CASE, folder, "there is no state to resume from");
}

bool checkpoint_write(const char *folder, const checkpoint *checkpoint, evl_error *error)
{
    (void)folder;
    (void)checkpoint;
    (void)error;
    return true;
}

void checkpoint_free(checkpoint *checkpoint)
{
    archive_free(&checkpoint->state);
    for (int i = 0; i < N_CHECKPOINT_TEXTS; i++) {
        free(checkpoint->texts[i]);
    }
    *checkpoint = (struct checkpoint){.t = 0};
}

/* Used by a store of wheels when it shares a folder, which never happens here. */

unsigned long long wheel_file_hash(const wheel_numbers *wheel)
{
    return (unsigned long long)wheel->n_key;
}

bool wheel_file_write(const char *path, const wheel_numbers *wheel, evl_error *error)
{
    (void)wheel;
    return evl_error_set(error, EVL_EXIT_IO, path, "the library writes no files");
}

wheel_file_status wheel_file_read(const char *path, const wheel_numbers *wheel, evl_error *error)
{
    (void)wheel;
    (void)evl_error_set(error, EVL_EXIT_CASE, path, "the library reads no files of wheels");
    return WHEEL_FILE_REFUSED;
}
