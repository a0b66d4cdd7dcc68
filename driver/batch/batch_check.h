/** Asks of every case of a shard whether it would be refused, without running any. */
#pragma once

#include "base/status.h"
#include "batch/batch_plan.h"

/** A line of JSON on stdout for each case that would be refused, and one for all of them. docs/batch.md describes them.
 *  @return EVL_EXIT_OK; EVL_EXIT_PARTIAL, with no error, if some would be refused; EVL_EXIT_INTERRUPTED with an error */
evl_exit batch_check(const batch_plan *plan, evl_error *error);
