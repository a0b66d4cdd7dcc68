/** A file that gets its name only when it is complete: it grows as NAME.partial under a lock. A leaf. */
#pragma once

#include <stdbool.h>
#include <stddef.h>

typedef struct {
    char *path, *partial_path;
    int descriptor; /**< holds the lock; -1 if none is open */
} output_file;

/** Open NAME.partial, creating it if it is not there, and lock it. Its content is left to the caller.
 *  @return false with one sentence in `message`; then nothing is open and nothing was created */
bool output_file_open(output_file *file, const char *path, char *message, size_t size);
/** Bring NAME.partial to the disk; if `commit`, let it replace NAME. Frees the file's memory in any case. */
bool output_file_close(output_file *file, bool commit, char *message, size_t size);
/** Let go of the lock and the memory; `remove` deletes NAME.partial as well. */
void output_file_drop(output_file *file, bool remove);

/** One sentence: the path, the reason, and what to do. `reason` NULL: that of the system error. */
void output_file_describe(const char *path, int system_error, const char *reason, char *message, size_t size);
