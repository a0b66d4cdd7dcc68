/** Cases of a batch that are responses: one file each, and their metrics in the journal. A batch that is stopped leaves
 *  their checkpoints next to the files, as `evolvent respond` does. */
#pragma once

#include "batch/batch_queue.h"
#include "batch/batch_row.h"

/** Create the folder of their files, if cases are responses. @return false with the reason in `error` */
bool batch_response_folder(const batch_plan *plan, evl_error *error);
/** Delete checkpoints of this shard's cases that are not to be run, left by a run that could not delete them.
 *  @param todo  [n] numbers of the cases to run, ascending */
void batch_response_retain(const batch_plan *plan, long n, const long *todo);
/** @return false with the reason in `refusal` */
bool batch_response_check(const batch_plan *plan, long index, evl_error *refusal);
/** As batch_case_run, for a case that was checked. */
bool batch_response_run(const batch_plan *plan, const batch_queue *queue, long index, batch_row *row, evl_error *error);
