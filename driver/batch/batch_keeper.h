/** The checkpoints of the case that a worker runs. A case that takes longer than their interval goes on from the last one when it is
 *  run again, whatever ended it; when the batch is asked to end, from there.
 *
 *  Only by radau: then they change no bit of a row. A case by IDA begins anew. */
#pragma once

#include "batch/batch_plan.h"
#include "batch/batch_queue.h"
#include "simulate/simulate.h"

typedef struct batch_keeper {
    const batch_plan *plan;
    const batch_queue *queue;      /**< which says when the batch is to end */
    const prepared_case *prepared; /**< the case */
    long index;
    bool can_go_on;     /**< the case is one of which checkpoints are made */
    bool has_some;      /**< there are checkpoints of it */
    archive from;       /**< what it goes on from; no bytes: from the start */
    bool waits;         /**< as of simulate_sink, there and in the checkpoints to come */
    double cpu_seconds; /**< of the simulations before this one, which missed something */
    double last;        /**< clock [s] of the last checkpoint, or the start */
    int countdown;      /**< steps to the next look at the clock */
    evl_error *error;   /**< why a checkpoint could not be made */
} batch_keeper;

/** Begin with a case, and find what it goes on from. What is damaged, or of something else, is told and does not count.
 *  @param error  where it is said why a checkpoint could not be made */
void batch_keeper_begin(batch_keeper *self, const batch_plan *plan, const batch_queue *queue, long index,
                        const prepared_case *prepared, evl_error *error);
void batch_keeper_end(batch_keeper *self);
/** What it goes on from; NULL: from the start. */
archive *batch_keeper_resume(batch_keeper *self);
/** Go on from the start after all. */
void batch_keeper_begin_anew(batch_keeper *self, bool waits, double cpu_seconds);

/* As of simulate_sink. */
bool batch_keeper_is_due(batch_keeper *self);
simulate_kept batch_keeper_kept(batch_keeper *self, double t, const archive *state);
