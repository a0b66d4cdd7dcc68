/** A file that is renamed when it is complete: it grows as NAME.partial under a lock. Leaf module. */
#pragma once

#include "base/status.h"

typedef struct {
    char *path, *partial_path, *fresh_path;
    int descriptor;       /**< holds the lock; -1 if none is open */
    int fresh_descriptor; /**< the same for the new file that will become NAME.partial */
    bool is_hidden;
    bool is_open_end; /**< writing continues after it is renamed: no checksum */
} output_file;

/** Open NAME.partial, creating it if necessary, lock it, and empty it.
 *  @return false with the reason in `error`, EVL_EXIT_IO; then nothing is open and nothing was created */
bool output_file_open(output_file *file, const char *path, evl_error *error);
/** Create an empty file next to NAME.partial: its content replaces NAME.partial completely, or not at all.
 *  @return 0, or the system error */
int output_file_begin_fresh(output_file *file);
/** Hide NAME.partial while it is written in place, so that a visible file is always readable. @return 0, or the system
 *  error */
int output_file_hide(output_file *file);
/** Rename the new, or hidden, file to NAME.partial. @return 0, or the system error */
int output_file_show(output_file *file);
/** Synchronise NAME.partial to the disk; if `commit`, add its checksum (files/checksum.h) and let it replace NAME. Frees
 *  the file's memory in any case. */
bool output_file_close(output_file *file, bool commit, evl_error *error);
/** Release the lock and the memory; `remove` deletes NAME.partial as well. */
void output_file_drop(output_file *file, bool remove);

/** EVL_EXIT_IO: the path, the reason and the remedy. `reason` NULL: that of the system error. @return false */
bool output_file_refuse(const char *path, int system_error, const char *reason, evl_error *error);
