#include "simulate/metric_blocks.h"

#include <math.h>

void metric_blocks_init(metric_blocks *blocks, int n_channels, memory_arena *arena)
{
    *blocks = (metric_blocks){.n_channels = n_channels, .each = 1};
    blocks->integrals = arena_calloc(arena, (size_t)n_channels * METRIC_BLOCKS, sizeof *blocks->integrals);
}

void metric_blocks_serialize(metric_blocks *blocks, archive *archive)
{
    SERIALIZE(archive, blocks->n);
    SERIALIZE(archive, blocks->each);
    SERIALIZE(archive, blocks->in_last);
    SERIALIZE(archive, blocks->time);
    SERIALIZE_ARRAY(archive, blocks->integrals, blocks->n_channels * METRIC_BLOCKS);
}

static void merge_neighbours(double of_blocks[METRIC_BLOCKS])
{
    for (int i = 0; i < METRIC_BLOCKS; i++) {
        const int other = 2 * i;
        of_blocks[i] = other < METRIC_BLOCKS ? of_blocks[other] + of_blocks[other + 1] : 0;
    }
}

void metric_blocks_period(metric_blocks *blocks, double time)
{
    if (blocks->n == METRIC_BLOCKS && blocks->in_last == blocks->each) {
        merge_neighbours(blocks->time);
        for (int channel = 0; channel < blocks->n_channels; channel++) {
            merge_neighbours(blocks->integrals + (size_t)channel * METRIC_BLOCKS);
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

void metric_blocks_add(metric_blocks *blocks, int channel, double integral)
{
    blocks->integrals[channel * METRIC_BLOCKS + blocks->n - 1] += integral;
}

/** Mean over n blocks from the first on; adds the squares of the blocks' deviations from it. */
static double mean_of(const metric_blocks *blocks, const double *integrals, int first, int n, double *squares)
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

bool metric_blocks_halves(const metric_blocks *blocks, int channel, block_halves *halves)
{
    const int n_full = blocks->in_last == blocks->each ? blocks->n : blocks->n - 1, half = n_full / 2;
    const double *integrals = blocks->integrals + (size_t)channel * METRIC_BLOCKS;
    double squares = 0;
    if (half < 2) {
        return false;
    }
    halves->first = mean_of(blocks, integrals, 0, half, &squares);
    halves->second = mean_of(blocks, integrals, n_full - half, half, &squares);
    halves->scatter = sqrt(squares / (2 * half - 2));
    return true;
}
