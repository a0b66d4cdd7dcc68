/** History of a long run as closed parts in a folder NAME.parts, each a readable history on disk: part-0001.h5,
 *  part-0002.h5 and so on. At the end they are combined to NAME. */
#pragma once

#include "base/lock.h"
#include "base/status.h"
#include "files/history.h"

typedef struct parts {
    char *folder;
    file_lock lock; /**< of the single run that may use the folder */
    int n;          /**< number of complete parts */
} parts;

/** Create the folder if necessary, and lock it.
 *  @param path  of the history
 *  @return false with the reason in `error`: EVL_EXIT_IO, or EVL_EXIT_CASE if another run uses it */
bool parts_open(parts *parts, const char *path, evl_error *error);
/** Release the folder. */
void parts_close(parts *parts);
/** NAME.parts of a history NAME: a new string. */
char *parts_folder(const char *path);
/** The name of a part, from 1: a new string. */
char *parts_path(const parts *parts, int index);
/** Retain the first n parts, delete all others, complete or not. @return false with the reason in `error`, EVL_EXIT_IO */
bool parts_retain(parts *parts, int n, evl_error *error);
/** Delete the folder with this program's files, the checkpoints first: without one the rest cannot be resumed. Other
 *  files remain, and the folder with them. */
void parts_remove(parts *parts);

/** Content of a part. */
typedef struct {
    long long rows, events;
} part_size;
/** @return false if it cannot be read */
bool part_size_of(const char *path, part_size *size);
/** Append all rows and events of a part to a history with the same outputs and states, block by block.
 *  @return false with the reason in `error`, EVL_EXIT_IO */
bool part_append(const char *path, history *to, evl_error *error);
