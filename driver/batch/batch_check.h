/** Check which cases of a shard would be refused, without running them. */
#pragma once

#include "base/status.h"
#include "batch/batch_plan.h"

/** Print a line of JSON on stdout for each case that would be refused, and one for all of them. docs/guides/batch.md describes
 *  them.
 *  @return whether some would be refused; also false with an error, EVL_EXIT_INTERRUPTED */
bool batch_check(const batch_plan *plan, evl_error *error);
