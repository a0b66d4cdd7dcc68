/** Complete writes in spite of signals, and synchronisation to the disk. Leaf module. */
#pragma once

#include <stdbool.h>
#include <sys/types.h>

/** @param offset  in the file; negative: the current one, at the end of a journal, or into a socket
 *  @return number of bytes written; if not all, errno has the reason */
size_t write_bytes(int descriptor, off_t offset, const void *bytes, size_t n);
/** Synchronise a file to the disk; files that cannot be, such as a pipe, count as done. @return false, with errno, if
 *  the disk fails */
bool sync_bytes(int descriptor);
/** Synchronise the folder of `path`: without it an existing file may lose its name in a power failure. Folders that do
 *  not support this are not an error. @return false, with errno, if the disk fails */
bool sync_name(const char *path);
