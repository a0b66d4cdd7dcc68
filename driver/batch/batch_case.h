/** One case of a batch: from its row in the design to its line in the journal. */
#pragma once

#include "batch/batch_queue.h"
#include "batch/batch_row.h"

/** Create a case and check all that can be refused, without the search for a periodic start.
 *  @param[in,out] of_case  as in batch_case_run
 *  @return false with the reason in `refusal` */
bool batch_case_check(const batch_plan *plan, long index, case_plan *of_case, evl_error *refusal);
/** Run a case, or resume it. Errors of the case are recorded in its row.
 *  @param queue  signals the end of the batch: then the row has no line
 *  @param[in,out] of_case  zeros before the first case, to be freed after the last one
 *  @return false with the reason in `error` if its history or a checkpoint could not be written, or the file of a wheel
 *          is invalid */
bool batch_case_run(const batch_plan *plan, const batch_queue *queue, long index, case_plan *of_case, batch_row *row,
                    evl_error *error);
/** The row of a case that terminated its process. */
void batch_case_lost(const batch_plan *plan, long index, const char *message, batch_row *row);
