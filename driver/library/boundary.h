/** Where a call of the library begins and ends: what its caller has set does not change its numbers, and what runs out of memory ends
 *  the call, not the process. */
#pragma once

#include "base/status.h"

#include <stddef.h>

/** Do something, as if this were a program of its own: locale "C", usual rounding. Where there is no memory it is left in the middle,
 *  with what it has taken, and `error` says so. */
void boundary_call(void (*work)(void *with), void *with, evl_error *error);
/** Leave the call that this thread is in, for want of so much memory; returns if it is in none. */
void boundary_leave(size_t count, size_t size);
