/** Means of quantities over parts of a window, in bounded memory: blocks with equal numbers of whole periods, doubled
 *  when all blocks are full. They show whether the means of both halves of the window agree. */
#pragma once

#include "base/archive.h"
#include "base/memory.h"

enum { NUMBER_BLOCKS = 32 };

typedef struct {
    int n_channels;
    int n;                      /**< number of blocks, the last of which may be incomplete */
    long each, in_last;         /**< periods of a block; of the last one */
    double time[NUMBER_BLOCKS]; /**< [s] */
    double *integrals;          /**< [n_channels * NUMBER_BLOCKS] over time */
} number_blocks;

/** @param pool  owns the integrals */
void number_blocks_init(number_blocks *blocks, int n_channels, memory_pool *pool);
void number_blocks_keep(number_blocks *blocks, archive *archive);
/** Start a period of this length [s]; its integrals are added afterwards, one per channel. */
void number_blocks_period(number_blocks *blocks, double time);
void number_blocks_add(number_blocks *blocks, int channel, double integral);

/** Means of a channel over the complete blocks of each half of the window. The scatter is the standard deviation of the
 *  block means about the mean of their half. */
typedef struct {
    double first, second, scatter;
} block_halves;
/** @return false if there are fewer than four complete blocks */
bool number_blocks_halves(const number_blocks *blocks, int channel, block_halves *halves);
