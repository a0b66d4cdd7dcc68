/** Lock for a folder or a part of it; it ends with the process that holds it, even after a crash. Leaf module. */
#pragma once

#include "base/status.h"

#include <stdbool.h>

typedef struct {
    int descriptor; /**< -1 if none is held */
} file_lock;

/** Lock `path`, a file that then names the holder; the file remains after the lock is released.
 *  @return false with the reason in `error`: EVL_EXIT_CASE naming the owner, if another process holds the lock;
 *          EVL_EXIT_IO */
bool file_lock_take(file_lock *lock, const char *path, evl_error *error);
void file_lock_release(file_lock *lock);
