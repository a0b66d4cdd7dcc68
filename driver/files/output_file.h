/** A file that gets its name only when it is complete: it grows as NAME.partial under a lock. A leaf. */
#pragma once

#include "base/status.h"

typedef struct {
    char *path, *partial_path;
    int descriptor; /**< holds the lock; -1 if none is open */
} output_file;

/** Open NAME.partial, creating it if it is not there, and lock it. Its content is left to the caller.
 *  @return false with the reason in `error`, EVL_EXIT_IO; then nothing is open and nothing was created */
bool output_file_open(output_file *file, const char *path, evl_error *error);
/** Bring NAME.partial to the disk; if `commit`, let it replace NAME. Frees the file's memory in any case. */
bool output_file_close(output_file *file, bool commit, evl_error *error);
/** Let go of the lock and the memory; `remove` deletes NAME.partial as well. */
void output_file_drop(output_file *file, bool remove);

/** EVL_EXIT_IO: the path, the reason, and what to do. `reason` NULL: that of the system error. @return false */
bool output_file_refuse(const char *path, int system_error, const char *reason, evl_error *error);
