/** Table of the metrics that a batch stores for each case. */
#pragma once

#include "base/memory.h"
#include "model/model.h"

/** Reductions of outputs to one number. Means and shares weight each output with its part of the time (trapezoidal
 *  rule). */
typedef enum {
    STATISTICS_MEAN,
    STATISTICS_RANGE, /**< largest minus smallest */
    STATISTICS_LARGEST,
    STATISTICS_SHARE_OF,  /**< of the time with exactly `pairs` */
    STATISTICS_SHARE_FROM /**< of the time with `pairs` or more */
} statistics_reduction;

/** One metric of a mesh. */
typedef struct {
    const char *name, *units, *long_name, *output;
    statistics_reduction reduction;
    int pairs;
} statistics_row;

/** Metrics of each mesh. */
enum { STATISTICS_OF_MESH = 9 };
extern const statistics_row statistics_of_mesh[STATISTICS_OF_MESH];

/** Metrics of the whole case, followed by the number of events of each kind. */
enum { STATISTICS_ENERGY_RESIDUAL, STATISTICS_STEPS, STATISTICS_CPU_TIME, STATISTICS_OF_CASE };

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
