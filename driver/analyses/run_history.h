/** The history of a run: what the case asks for, row by row, and what is known at the end. */
#pragma once

#include "files/history.h"
#include "simulate/simulate.h"

/** Of rows or events. */
typedef struct {
    long written, to_come; /**< to_come: of those written, that the simulation will tell once more */
} run_history_count;

typedef struct {
    const prepared_case *prepared;
    memory_pool pool; /**< of the outputs */
    wanted_outputs wanted;
    int n_told;            /**< values of the outputs */
    double *row;           /**< values of the outputs, of those of a grid of positions, and the constants */
    history_layout layout; /**< outputs and states, with their places in a row */
    history *history;      /**< NULL: none is open */
    run_history_count rows, events;
    extremes *extremes;
    numbers *numbers; /**< NULL: the case does not ask for them */
} run_history;

/** Find what it is to hold. */
void run_history_init(run_history *self, const prepared_case *prepared);
/** Look for extremes and numbers from the start on, as a simulation is to begin; after one before, anew. */
void run_history_watch(run_history *self);
/** Create a file with all that is known at the start. @return false with the reason in `error`, as the others do */
bool run_history_open(run_history *self, const char *path, evl_error *error);

/** Take what the simulation tells. */
bool run_history_outputs(run_history *self, const output_block *block, evl_error *error);
bool run_history_event(run_history *self, const event_record *record, evl_error *error);
/** The simulation is made anew: what is written comes once more, the same, and is passed over. */
void run_history_again(run_history *self);

/** Put what is known at the end. */
bool run_history_put(const run_history *self, evl_error *error);
/** Say how the run ended, and give the file its name if it came to its end.
 *  @param who          has interrupted it, if so
 *  @param checkpoints  model times at which it may have started anew; "" if there are none */
bool run_history_close(run_history *self, const char *who, const simulate_result *result, const char *checkpoints,
                       evl_error *error);
/** Drop what cannot be written. */
void run_history_abandon(run_history *self);
/** Where it is until then. */
const char *run_history_partial_path(const run_history *self);
void run_history_free(run_history *self);
