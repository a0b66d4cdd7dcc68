/** Which cases a run of a shard has to do. */
#pragma once

#include "batch/batch_plan.h"
#include "batch/journal.h"

/** Number of the shard's cases. */
long batch_shard_size(const batch_plan *plan);
/** The shard's cases of which nothing is recorded; or those that a file names, one number a line, recorded or not. A first
 *  line "after N" leaves out those that the journal records behind its first N: they were run since the file was written.
 *  @param cases_path  NULL: no such file
 *  @param cases       [n_cases] what is recorded
 *  @param todo        a new array
 *  @return false with the reason in `error` */
bool batch_todo(const batch_plan *plan, const char *cases_path, const journal_case *cases, long **todo, long *n_todo,
                evl_error *error);
