/** Metrics stored by a batch for each case, accumulated during the simulation, according to one table. */
#pragma once

#include "base/archive.h"
#include "base/memory.h"
#include "integrate/integrate_types.h"
#include "model/model.h"
#include "simulate/simulate.h"

/** One metric of a case. */
typedef struct {
    const char *name, *units, *long_name;
} statistics_scalar;

/** A metric over whole periods: its index among them, and that of its scalar. */
typedef struct {
    int index, scalar;
} statistics_metric;

/** Common data of all cases of a batch. */
typedef struct {
    memory_arena arena;
    model_names names; /**< of the base case; only meshes, wheels and accelerometers */
    int n_meshes, n;
    statistics_scalar *scalars; /**< [n] those of a mesh together, then those of the whole case, then further metrics */
    bool *taken;   /**< [N_METRIC_ROWS] metrics over whole periods; they replace scalars of the same name */
    int n_metrics; /**< 0: none */
    statistics_metric *metrics; /**< [n_metrics] */
    int settled;    /**< scalar for whether the motion is settled in the window; -1: none, without metrics */
    int multiplier; /**< scalar of the orbit on which the case starts; -1: none */
} statistics_table;

/** The table for cases with these meshes, wheels and accelerometers. With several meshes each has its own metrics:
 *  NAME_MESH; those of the others are NAME_WHEEL, NAME_ACCELEROMETER.
 *  @param names          must outlive the table
 *  @param words          requested metrics over whole periods, as in metric_rows_select
 *  @param some_periodic  whether a case may start on a periodic orbit. @return NULL, or the first unknown word */
const char *statistics_table_init(statistics_table *table, const model_names *names, int n_words,
                                  const char *const *words, bool some_periodic);

/** A table of metrics over whole periods only, with space for `more` scalars behind them. @return as above */
const char *statistics_table_of_metrics(statistics_table *table, const model_names *names, int n_words,
                                        const char *const *words, int more);

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
