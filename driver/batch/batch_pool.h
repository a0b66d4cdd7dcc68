/** The parent of a batch's workers: starts and replaces them, records what they send. */
#pragma once

#include "batch/batch_plan.h"
#include "batch/journal.h"

typedef struct {
    journal journal;
    journal_case *cases; /**< [n_cases] */
    long *todo; /**< numbers of the cases to run, in their order; batch_pool_run leaves what is not recorded in front */
    long n_todo;
    long n_finished; /**< of them, so far */
    long n_wheels;   /**< that give way and were computed for them */
} batch_state;

/** Run all that is to do in `jobs` workers. Interrupted by a signal, or if something cannot be written, it ends what runs,
 *  brings to the disk what is recorded, and says so in `error`. */
void batch_pool_run(const batch_plan *plan, int jobs, bool show_progress, batch_state *state, evl_error *error);
