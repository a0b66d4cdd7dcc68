/** Means of quantities over parts of a window, in bounded memory: blocks of as many whole periods each, twice as many once all blocks
 *  are full. They say whether the means of both halves of the window agree. */
#pragma once

#include "base/archive.h"
#include "base/memory.h"

enum { NUMBER_BLOCKS = 32 };

typedef struct {
    int n_channels;
    int n;                      /**< blocks, of which the last may not be full */
    long each, in_last;         /**< periods of a block; of the last one */
    double time[NUMBER_BLOCKS]; /**< [s] */
    double *integrals;          /**< [n_channels * NUMBER_BLOCKS] over time */
} number_blocks;

/** @param pool  in which the integrals last */
void number_blocks_init(number_blocks *blocks, int n_channels, memory_pool *pool);
void number_blocks_keep(number_blocks *blocks, archive *archive);
/** Begin with a period of this length [s]; its integrals are added then, one a channel. */
void number_blocks_period(number_blocks *blocks, double time);
void number_blocks_add(number_blocks *blocks, int channel, double integral);

/** Means of a channel over the full blocks of both halves of the window, and the standard deviation of the means of blocks about
 *  that of their half. */
typedef struct {
    double first, second, scatter;
} block_halves;
/** @return false if there are less than four full blocks */
bool number_blocks_halves(const number_blocks *blocks, int channel, block_halves *halves);
