/** What the numbers of a window are made of: sums of all quantities and meshes over parts of steps. numbers.h has the window. */
#pragma once

#include "simulate/number_blocks.h"
#include "simulate/number_rows.h"

/** One element of an output. */
typedef struct sums_channel sums_channel;

typedef struct {
    const model *model;
    const bool *taken; /**< [N_NUMBER_ROWS] rows that are wanted */
    int n_meshes, n_channels, n_pairs;
    mesh_numbers *meshes;
    sums_channel *channels;
    int first[N_NUMBER_QUANTITIES]; /**< channel of each quantity; -1: it is not followed */
    number_blocks blocks;           /**< of the channels */
    number_waves *waves;            /**< [n_meshes] */
    step_nodes nodes;               /**< of the part of a step that is looked at */
    mesh_places places;
} number_sums;

/** @param pool  in which the arrays last */
void number_sums_init(number_sums *sums, const model *model, const bool *taken, memory_pool *pool);
void number_sums_clear(number_sums *sums);
void number_sums_keep(number_sums *sums, archive *archive);
/** Before the first sum: what never changes.
 *  @param values     outputs at any state
 *  @param preferred  mesh whose pitches harmonics are of where there is a choice */
void number_sums_begin(number_sums *sums, const double *values, int preferred);
/** Add what is known at the nodes, to the present period. */
void number_sums_add(number_sums *sums);
/** The present period is complete: it counts. */
void number_sums_complete(number_sums *sums);
/** A quantity that is followed, and what is known of it. */
typedef struct {
    int quantity, element; /**< in the table of quantities; of that quantity */
    channel_window window;
    bool has_halves; /**< there are means of both halves of the window */
    block_halves halves;
} number_followed;
void number_sums_followed(const number_sums *sums, int channel, number_followed *followed);
/** Values of the rows that are wanted. @param rows  as number_rows_place places them */
void number_sums_conclude(const number_sums *sums, const model_output *rows, double *values);
