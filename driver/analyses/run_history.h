/** History of a run: the requested outputs row by row, and the results at the end. */
#pragma once

#include "files/history.h"
#include "simulate/simulate.h"

/** Count of rows or events. */
typedef struct {
    long written, to_come; /**< to_come: of those written, the number that the repeated simulation will produce again */
} run_history_count;

typedef struct {
    const case_plan *plan;
    const model_start_orbit *start; /**< orbit of the start, from case_start */
    memory_arena arena;             /**< owns the outputs */
    requested_outputs requested;
    int n_output_values;   /**< values of the outputs */
    double *row;           /**< values of the outputs, of those of a position grid, and the constants */
    history_layout layout; /**< outputs and states, with their offsets in a row */
    history *history;      /**< NULL: none is open */
    run_history_count rows, events;
    extremes *extremes;
    metrics *metrics; /**< NULL: not requested by the case */
} run_history;

/** Determine the content. */
void run_history_init(run_history *self, const case_plan *plan, const model_start_orbit *start);
/** Start the evaluation of extremes and metrics, before a simulation; after an earlier one, start again. */
void run_history_monitor(run_history *self);
/** Simulate with buffered outputs, extremes and metrics; if the outputs show that an event was missed, repeat the
 *  simulation without buffer.
 *  @param sink   its other members; may change until the repetition
 *  @param again  prepares the repetition of all since sink->resume, false: SIMULATE_SINK_FAILED; NULL: run_history_again */
void run_history_simulate(run_history *self, simulate_sink *sink, const dae_state *start, bool (*again)(void *self),
                          simulate_result *result);
/** Create a file with all data known at the start. @return false with the reason in `error`, as the other functions */
bool run_history_open(run_history *self, const char *path, evl_error *error);

/** Write outputs of the simulation. */
bool run_history_outputs(run_history *self, const output_block *block, evl_error *error);
bool run_history_event(run_history *self, const event_record *record, evl_error *error);
/** The simulation is repeated: rows and events already written occur again, identically, and are skipped. */
void run_history_again(run_history *self);

/** Write the results at the end. */
bool run_history_put(const run_history *self, evl_error *error);
/** Write how the run ended, and rename the file if it is complete.
 *  @param who          name of the interrupt's source, if any
 *  @param checkpoints  model times of checkpoints, at which it may have been resumed; "" if there are none */
bool run_history_close(run_history *self, const char *who, const simulate_result *result, const char *checkpoints,
                       evl_error *error);
/** Discard the file after a write error. */
void run_history_abandon(run_history *self);
/** Path of the file before it is complete. */
const char *run_history_partial_path(const run_history *self);
void run_history_free(run_history *self);
