/** Metrics stored by a batch for each case, accumulated during the simulation, according to one table. */
#pragma once

#include "base/archive.h"
#include "batch/batch_statistics_table.h"
#include "integrate/integrate_types.h"
#include "model/model.h"
#include "simulate/simulate.h"

typedef struct statistics statistics;

/** Start a case with the meshes and wheels of the table, and request the outputs needed.
 *  @param window  time window of all metrics of a mesh [s], both ends included */
statistics *statistics_create(const statistics_table *table, requested_outputs *requested, const metric_window *window,
                              double output_interval);
void statistics_delete(statistics **statistics);
/** The extremes in the window, which the simulation searches between the outputs. */
extremes *statistics_extremes(const statistics *statistics);
/** The metrics over whole periods; NULL if there are none. */
metrics *statistics_metrics(const statistics *statistics);

/** Process a block; blocks are passed in order of time. */
void statistics_outputs(statistics *statistics, const output_block *block);
void statistics_event(statistics *statistics, const event_record *record);
/** Serialise the accumulated values, except those of the simulation: extremes and metrics over whole periods. */
void statistics_serialize(statistics *statistics, archive *archive);
/** Whether the window contained any output. */
bool statistics_has_outputs(const statistics *statistics);
/** Metrics of the table; NaN where nothing was accumulated.
 *  @param multiplier  that of largest magnitude of the orbit on which the case starts; NaN without one
 *  @param result   of the simulation; if it is incomplete, the metrics of the meshes, whose window is not full, are NaN
 *  @param results      [table.n] */
void statistics_finish(const statistics *statistics, const simulate_result *result, double multiplier, double *results);
