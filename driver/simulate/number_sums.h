/** Accumulation of the metrics of a window: sums of all quantities and meshes over parts of steps. The window is
 *  defined in numbers.h. */
#pragma once

#include "simulate/number_blocks.h"
#include "simulate/number_rows.h"

/** One element of an output. */
typedef struct sums_channel sums_channel;

typedef struct {
    const model *model;
    const bool *taken; /**< [N_NUMBER_ROWS] requested rows */
    int n_meshes, n_channels, n_pairs;
    mesh_numbers *meshes;
    sums_channel *channels;
    int first[N_NUMBER_QUANTITIES]; /**< first channel of each quantity; -1: not evaluated */
    number_blocks blocks;           /**< of the channels */
    number_waves *waves;            /**< [n_meshes] */
    step_nodes nodes;               /**< of the present part of a step */
    mesh_places places;
} number_sums;

/** @param pool  owns the arrays */
void number_sums_init(number_sums *sums, const model *model, const bool *taken, memory_pool *pool);
void number_sums_clear(number_sums *sums);
void number_sums_keep(number_sums *sums, archive *archive);
/** Set the constants before the first sum.
 *  @param values     outputs at any state
 *  @param preferred  mesh whose pitch defines the harmonics if there are several candidates */
void number_sums_begin(number_sums *sums, const double *values, int preferred);
/** Add the values at the nodes to the present period. */
void number_sums_add(number_sums *sums);
/** Complete the present period and add it to the total. */
void number_sums_complete(number_sums *sums);
/** An evaluated quantity and its statistics. */
typedef struct {
    int quantity, element; /**< in the table of quantities; within that quantity */
    channel_window window;
    bool has_halves; /**< means of both halves of the window are available */
    block_halves halves;
} number_followed;
void number_sums_followed(const number_sums *sums, int channel, number_followed *followed);
/** Values of the requested rows. @param rows  as from number_rows_place */
void number_sums_conclude(const number_sums *sums, const model_output *rows, double *values);
