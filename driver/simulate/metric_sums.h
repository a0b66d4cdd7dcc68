/** Accumulation of the metrics of a window: sums of all quantities and meshes over parts of steps. The window is
 *  defined in metrics.h. */
#pragma once

#include "simulate/metric_blocks.h"
#include "simulate/metric_rows.h"

/** One element of an output. */
typedef struct sums_channel sums_channel;

typedef struct {
    const model *model;
    const bool *taken; /**< [N_METRIC_ROWS] requested rows */
    int n_meshes, n_channels, n_pairs;
    mesh_metrics *meshes;
    sums_channel *channels;
    int first[N_METRIC_QUANTITIES]; /**< first channel of each quantity; -1: not evaluated */
    metric_blocks blocks;           /**< of the channels */
    metric_waves *waves;            /**< [n_meshes] */
    step_nodes nodes;               /**< of the present part of a step */
    mesh_indices indices;
    output_extremes roots, temperatures;
    root_ranges ranges;
} metric_sums;

/** @param arena  owns the arrays */
void metric_sums_init(metric_sums *sums, const model *model, const bool *taken, memory_arena *arena);
void metric_sums_clear(metric_sums *sums);
void metric_sums_serialize(metric_sums *sums, archive *archive);
/** Set the constants before the first sum.
 *  @param values     outputs at any state
 *  @param preferred  mesh whose pitch defines the harmonics if there are several candidates */
void metric_sums_begin(metric_sums *sums, const double *values, int preferred);
/** Add the part of a step whose nodes were evaluated to the present period. */
void metric_sums_add(metric_sums *sums, const integrate_step *step, double from, double to);
/** Complete the present period and add it to the total. */
void metric_sums_complete(metric_sums *sums);
/** An evaluated quantity and its statistics. */
typedef struct {
    int quantity, element; /**< in the table of quantities; within that quantity */
    channel_window window;
    bool has_halves; /**< means of both halves of the window are available */
    block_halves halves;
} metric_statistics;
void metric_sums_statistics(const metric_sums *sums, int channel, metric_statistics *followed);
/** Values of the requested rows. @param rows  as from metric_rows_lay_out */
void metric_sums_conclude(const metric_sums *sums, const model_output *rows, double *values);
