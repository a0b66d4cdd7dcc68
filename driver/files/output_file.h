/** A file that gets its name only when it is complete: it grows as NAME.partial under a lock. A leaf. */
#pragma once

#include "base/status.h"

typedef struct {
    char *path, *partial_path, *fresh_path;
    int descriptor;       /**< holds the lock; -1 if none is open */
    int fresh_descriptor; /**< the same of what is to become NAME.partial */
    bool is_hidden;
    bool is_open_end; /**< it is written on when it has its name: no seal */
} output_file;

/** Open NAME.partial, creating it if it is not there, lock it, and empty it.
 *  @return false with the reason in `error`, EVL_EXIT_IO; then nothing is open and nothing was created */
bool output_file_open(output_file *file, const char *path, evl_error *error);
/** Create an empty file beside NAME.partial: what is written there can be read under that name as a whole, or not at all.
 *  @return 0, or the system error */
int output_file_begin_fresh(output_file *file);
/** While NAME.partial is written in place it is not there: whoever sees it, or is left with it, can read it. @return 0, or the
 *  system error */
int output_file_hide(output_file *file);
/** Let what was begun, or hidden, be NAME.partial. @return 0, or the system error */
int output_file_show(output_file *file);
/** Bring NAME.partial to the disk; if `commit`, seal it (files/seal.h) and let it replace NAME. Frees the file's memory in any case. */
bool output_file_close(output_file *file, bool commit, evl_error *error);
/** Let go of the lock and the memory; `remove` deletes NAME.partial as well. */
void output_file_drop(output_file *file, bool remove);

/** EVL_EXIT_IO: the path, the reason, and what to do. `reason` NULL: that of the system error. @return false */
bool output_file_refuse(const char *path, int system_error, const char *reason, evl_error *error);
