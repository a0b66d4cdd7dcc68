/** The history of a long run as closed parts in a folder NAME.parts, each a history by itself, on disk and readable: part-0001.h5,
 *  part-0002.h5 and so on. At the end they become NAME. */
#pragma once

#include "base/lock.h"
#include "base/status.h"
#include "files/history.h"

typedef struct parts {
    char *folder;
    file_lock lock; /**< of the one run that may work here */
    int n;          /**< parts that are complete */
} parts;

/** Make the folder, if it is not there, and lock it.
 *  @param path  of the history
 *  @return false with the reason in `error`: EVL_EXIT_IO, or EVL_EXIT_CASE if another run is at work there */
bool parts_open(parts *parts, const char *path, evl_error *error);
/** Let go of it. */
void parts_close(parts *parts);
/** NAME.parts of a history NAME: a new string. */
char *parts_folder(const char *path);
/** The name of a part, from 1: a new string. */
char *parts_path(const parts *parts, int index);
/** Keep the first n parts, delete all others, complete or not. @return false with the reason in `error`, EVL_EXIT_IO */
bool parts_keep(parts *parts, int n, evl_error *error);
/** Delete the folder with what this program puts there, the checkpoints first: without one nobody goes on from the rest. Other files
 *  stay, and the folder with them. */
void parts_remove(parts *parts);

/** What a part holds. */
typedef struct {
    long long rows, events;
} part_size;
/** @return false if it cannot be read */
bool part_size_of(const char *path, part_size *size);
/** Append all rows and events of a part to a history with the same outputs and states, block by block.
 *  @return false with the reason in `error`, EVL_EXIT_IO */
bool part_append(const char *path, history *to, evl_error *error);
