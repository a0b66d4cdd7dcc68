/** Lines on stderr about a response that is done. */
#pragma once

#include "respond/branch.h"

enum { RESPOND_MOST = 1000000 }; /**< common periods at a value */

/** Warn of motions that still settle: of the slowest one, with the number of common periods that it needs. */
void respond_warn_of_settling(const branch *branch);
/** Print the jumps, and how many motions are of which kind. */
void respond_summarise(const branch *branch, const char *path);
