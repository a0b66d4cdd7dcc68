/** Checksum of a file: a line with the checksum of all other bytes, to detect damage before a library reads the file.
 *  docs/reference/result_format.md describes it. Leaf module, independent of HDF5.
 *
 *  The line is at the front, in the user block of HDF5 (plans), or at the end, behind the data read by HDF5: programs
 *  recognise histories by their first bytes. */
#pragma once

#include "base/status.h"

#include <stdbool.h>

typedef enum { CHECKSUM_CORRECT, CHECKSUM_NONE, CHECKSUM_WRONG, CHECKSUM_UNREADABLE } checksum_status;

/** Append the checksum to a file that is open for reading and writing. @return false with the reason in errno */
bool checksum_append(int descriptor);
/** Same for its first `n` bytes: the following bytes are written later and have other checksums. */
bool checksum_append_of_first(int descriptor, long long n);
/** Read the complete file and verify its checksum. CHECKSUM_UNREADABLE: errno has the reason. */
checksum_status checksum_verify(const char *path);
