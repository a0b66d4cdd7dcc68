/** Writing all bytes, however often a signal comes between. A leaf. */
#pragma once

#include <sys/types.h>

/** @param offset  in the file; negative: where it stands, at the end of a journal, or into a socket
 *  @return how many were written; if not all, errno says why */
size_t write_bytes(int descriptor, off_t offset, const void *bytes, size_t n);
