/** Asks of every case of a shard whether it would be refused, without running any. */
#pragma once

#include "base/status.h"
#include "batch/batch_plan.h"

/** A line of JSON on stdout for each case that would be refused, and one for all of them. docs/batch.md describes them.
 *  @return whether some would be refused; false too with an error, EVL_EXIT_INTERRUPTED */
bool batch_check(const batch_plan *plan, evl_error *error);
