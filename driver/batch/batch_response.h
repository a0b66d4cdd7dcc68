/** Cases of a batch that are responses: a file each, and their numbers in the journal. A batch that is stopped keeps how far they are beside
 *  their files, as `evolvent respond` does. */
#pragma once

#include "batch/batch_queue.h"
#include "batch/batch_row.h"

/** What can be refused of the design as a whole. @return false with the reason in `error` */
bool batch_response_check_design(const design *design, evl_error *error);
/** The numbers of a response: the largest of those over whole periods that words name, jumps, periods. As of statistics_table_init. */
const char *batch_response_table(statistics_table *table, const model_names *names, int n_words,
                                 const char *const *words);
/** Make the folder of their files, if cases are responses. @return false with the reason in `error` */
bool batch_response_folder(const batch_plan *plan, evl_error *error);
/** Delete what is kept of this shard's cases that are not to be run, which a run that could not delete it may have left.
 *  @param todo  [n] numbers of the cases that are, rising */
void batch_response_keep(const batch_plan *plan, long n, const long *todo);
/** @return false with the reason in `refusal` */
bool batch_response_check(const batch_plan *plan, long index, evl_error *refusal);
/** As batch_case_run, of a case that was checked. */
bool batch_response_run(const batch_plan *plan, const batch_queue *queue, long index, batch_row *row, evl_error *error);
