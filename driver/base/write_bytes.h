/** Writing all bytes, however often a signal comes between, and bringing them to the disk. A leaf. */
#pragma once

#include <stdbool.h>
#include <sys/types.h>

/** @param offset  in the file; negative: where it stands, at the end of a journal, or into a socket
 *  @return how many were written; if not all, errno says why */
size_t write_bytes(int descriptor, off_t offset, const void *bytes, size_t n);
/** Bring a file to the disk; what cannot be, such as a pipe, counts as there. @return false, with errno, if the disk fails */
bool sync_bytes(int descriptor);
/** Bring to the disk that there is a file of this name: without it a file that is there may be without a name after a loss of
 *  power. Folders that know no such thing are no reason to fail. @return false, with errno, if the disk fails */
bool sync_name(const char *path);
