/** Checkpoints of the case run by a worker. A case that takes longer than their interval is resumed from the last one
 *  when it is run again, however it ended; when the batch is stopped, from that point.
 *
 *  Only with radau: then they do not change any bit of a row. A case with IDA starts again. */
#pragma once

#include "batch/batch_plan.h"
#include "batch/batch_queue.h"
#include "simulate/simulate.h"

typedef struct batch_checkpointer {
    const batch_plan *plan;
    const batch_queue *queue; /**< signals the end of the batch */
    const case_plan *of_case; /**< the case */
    long index;
    bool can_go_on;     /**< checkpoints of the case are possible */
    bool has_some;      /**< there are checkpoints of it */
    archive from;       /**< state to resume from; no bytes: from the start */
    bool waits;         /**< as in simulate_sink, there and in later checkpoints */
    double cpu_seconds; /**< of the earlier simulations of this case, which missed an event */
    double last;        /**< wall clock [s] of the last checkpoint, or of the start */
    int countdown;      /**< steps to the next reading of the clock */
    evl_error *error;   /**< why a checkpoint could not be written */
} batch_checkpointer;

/** Start a case, and find its checkpoint. Checkpoints that are damaged, or of something else, are reported and ignored.
 *  @param error  receives the reason if a checkpoint could not be written */
void batch_checkpointer_begin(batch_checkpointer *self, const batch_plan *plan, const batch_queue *queue, long index,
                              const case_plan *of_case, evl_error *error);
void batch_checkpointer_end(batch_checkpointer *self);
/** State to resume from; NULL: from the start. */
archive *batch_checkpointer_resume(batch_checkpointer *self);
/** Start again from the beginning. */
void batch_checkpointer_begin_anew(batch_checkpointer *self, bool waits, double cpu_seconds);

/* As in simulate_sink. */
bool batch_checkpointer_is_due(batch_checkpointer *self);
simulate_checkpoint_outcome batch_checkpointer_write(batch_checkpointer *self, double t, const archive *state);
