/** Means of quantities over parts of a window, in bounded memory: blocks with equal numbers of whole periods, doubled
 *  when all blocks are full. They show whether the means of both halves of the window agree. */
#pragma once

#include "base/archive.h"
#include "base/memory.h"

enum { METRIC_BLOCKS = 32 };

typedef struct {
    int n_channels;
    int n;                      /**< number of blocks, the last of which may be incomplete */
    long each, in_last;         /**< periods of a block; of the last one */
    double time[METRIC_BLOCKS]; /**< [s] */
    double *integrals;          /**< [n_channels * METRIC_BLOCKS] over time */
} metric_blocks;

/** @param arena  owns the integrals */
void metric_blocks_init(metric_blocks *blocks, int n_channels, memory_arena *arena);
void metric_blocks_serialize(metric_blocks *blocks, archive *archive);
/** Start a period of this length [s]; its integrals are added afterwards, one per channel. */
void metric_blocks_period(metric_blocks *blocks, double time);
void metric_blocks_add(metric_blocks *blocks, int channel, double integral);

/** Means of a channel over the complete blocks of each half of the window. The scatter is the standard deviation of the
 *  block means about the mean of their half. */
typedef struct {
    double first, second, scatter;
} block_halves;
/** @return false if there are fewer than four complete blocks */
bool metric_blocks_halves(const metric_blocks *blocks, int channel, block_halves *halves);
