/** Summary on stderr of a complete response. */
#pragma once

#include "respond/branch.h"

enum { RESPOND_MOST = 1000000 }; /**< limit of common periods at a value */

/** Warn of motions that have not settled: name the slowest one and the number of common periods that it needs. */
void respond_warn_of_settling(const branch *branch);
/** Print the jumps, and the number of motions of each kind. */
void respond_summarise(const branch *branch, const char *path);
