/** Parent of a batch's workers: starts and replaces them, records their results. */
#pragma once

#include "batch/batch_plan.h"
#include "batch/journal.h"

typedef struct {
    journal journal;
    journal_case *cases; /**< [n_cases] */
    long *todo;          /**< cases to run, in order; batch_supervisor_run moves those not recorded to the front */
    long n_todo;
    long n_finished; /**< number of them finished so far */
    long n_wheels;   /**< number of compliant wheels computed for them */
} batch_state;

/** Run all cases to do in `jobs` workers. After a signal or a failed write it stops the running cases, synchronises the
 *  records to the disk, and reports this in `error`. */
void batch_supervisor_run(const batch_plan *plan, int jobs, bool show_progress, batch_state *state, evl_error *error);
