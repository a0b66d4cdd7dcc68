/** A lock on a folder's part that ends with the process that holds it, however that ends. A leaf. */
#pragma once

#include "base/status.h"

#include <stdbool.h>

typedef struct {
    int descriptor; /**< -1 if none is held */
} file_lock;

/** Lock `path`, a file that then tells who holds it; it stays when the lock goes.
 *  @return false with the reason in `error`: EVL_EXIT_CASE naming the owner, if another process holds it; EVL_EXIT_IO */
bool file_lock_take(file_lock *lock, const char *path, evl_error *error);
void file_lock_release(file_lock *lock);
