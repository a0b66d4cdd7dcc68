#include "simulate/number_blocks.h"

#include <math.h>

void number_blocks_init(number_blocks *blocks, int n_channels, memory_pool *pool)
{
    *blocks = (number_blocks){.n_channels = n_channels, .each = 1};
    blocks->integrals = pool_calloc(pool, (size_t)n_channels * NUMBER_BLOCKS, sizeof *blocks->integrals);
}

void number_blocks_keep(number_blocks *blocks, archive *archive)
{
    KEEP(archive, blocks->n);
    KEEP(archive, blocks->each);
    KEEP(archive, blocks->in_last);
    KEEP(archive, blocks->time);
    KEEP_ARRAY(archive, blocks->integrals, blocks->n_channels * NUMBER_BLOCKS);
}

static void merge_neighbours(double of_blocks[NUMBER_BLOCKS])
{
    for (int i = 0; i < NUMBER_BLOCKS; i++) {
        const int other = 2 * i;
        of_blocks[i] = other < NUMBER_BLOCKS ? of_blocks[other] + of_blocks[other + 1] : 0;
    }
}

void number_blocks_period(number_blocks *blocks, double time)
{
    if (blocks->n == NUMBER_BLOCKS && blocks->in_last == blocks->each) {
        merge_neighbours(blocks->time);
        for (int channel = 0; channel < blocks->n_channels; channel++) {
            merge_neighbours(blocks->integrals + (size_t)channel * NUMBER_BLOCKS);
        }
        blocks->n /= 2;
        blocks->each *= 2;
        blocks->in_last = blocks->each;
    }
    if (blocks->n == 0 || blocks->in_last == blocks->each) {
        blocks->n++;
        blocks->in_last = 0;
    }
    blocks->in_last++;
    blocks->time[blocks->n - 1] += time;
}

void number_blocks_add(number_blocks *blocks, int channel, double integral)
{
    blocks->integrals[channel * NUMBER_BLOCKS + blocks->n - 1] += integral;
}

/** Mean over n blocks from the first on; adds the squares of the blocks' deviations from it. */
static double mean_of(const number_blocks *blocks, const double *integrals, int first, int n, double *squares)
{
    double integral = 0, time = 0;
    for (int i = first; i < first + n; i++) {
        integral += integrals[i];
        time += blocks->time[i];
    }
    for (int i = first; i < first + n; i++) {
        const double distance = integrals[i] / blocks->time[i] - integral / time;
        *squares += distance * distance;
    }
    return integral / time;
}

bool number_blocks_halves(const number_blocks *blocks, int channel, block_halves *halves)
{
    const int n_full = blocks->in_last == blocks->each ? blocks->n : blocks->n - 1, half = n_full / 2;
    const double *integrals = blocks->integrals + (size_t)channel * NUMBER_BLOCKS;
    double squares = 0;
    if (half < 2) {
        return false;
    }
    halves->first = mean_of(blocks, integrals, 0, half, &squares);
    halves->second = mean_of(blocks, integrals, n_full - half, half, &squares);
    halves->scatter = sqrt(squares / (2 * half - 2));
    return true;
}
