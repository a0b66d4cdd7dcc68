/** Entry and exit of library calls: the caller's settings do not affect the results, and insufficient memory ends the
 *  call, not the process. */
#pragma once

#include "base/status.h"

#include <stddef.h>

/** Execute a function as in a program of its own: locale "C", default rounding. On insufficient memory it is abandoned
 *  without freeing its memory, and `error` reports this. */
void boundary_call(void (*work)(void *with), void *with, evl_error *error);
/** Leave the present call of this thread because an allocation of that size failed; returns if there is none. */
void boundary_leave(size_t count, size_t size);
