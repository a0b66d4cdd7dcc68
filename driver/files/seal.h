/** The seal of a file: a line that tells the check sum of all other bytes, so that damage is noticed before a library reads
 *  the file. docs/result_format.md describes it. A leaf: knows nothing of HDF5.
 *
 *  It stands at the front, where HDF5 leaves room for its user (plans), or at the end, behind what HDF5 reads: programs know
 *  histories by their first bytes. */
#pragma once

#include "base/status.h"

#include <stdbool.h>

typedef enum { SEAL_HOLDS, SEAL_NONE, SEAL_BROKEN, SEAL_UNREADABLE } seal_answer;

/** Seal a file, open for reading and writing, at its end. @return false with the reason in errno */
bool seal_put(int descriptor);
/** The same for its first `n` bytes: what follows is written later, and has checks elsewhere. */
bool seal_put_on_first(int descriptor, long long n);
/** Read all of a file and hold it against its seal. SEAL_UNREADABLE: errno says why. */
seal_answer seal_check(const char *path);
