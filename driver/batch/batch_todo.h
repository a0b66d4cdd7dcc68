/** Selection of the cases of a shard to run. */
#pragma once

#include "batch/batch_plan.h"
#include "batch/journal.h"

/** Number of the shard's cases. */
long batch_shard_size(const batch_plan *plan);
/** The shard's cases that are not recorded; or those listed in a file, one number a line, recorded or not. A first line
 *  "after N" excludes those that the journal records behind its first N: they were run since the file was written.
 *  @param cases_path  NULL: no such file
 *  @param cases       [n_cases] recorded results
 *  @param todo        a new array
 *  @return false with the reason in `error` */
bool batch_todo(const batch_plan *plan, const char *cases_path, const journal_case *cases, long **todo, long *n_todo,
                evl_error *error);
