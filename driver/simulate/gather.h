/** States at which outputs are due, gathered until the kernel takes them at once. */
#pragma once

#include "simulate/wanted.h"

typedef struct gather {
    memory_pool pool;
    const wanted_outputs *wanted;
    model_sampler *sampler;
    int capacity; /**< states that it waits for */
    int n;        /**< that it has */
    double t[DAE_LANES];
    output_mark marks[DAE_LANES];
    bool has_marks;
    double *y;      /**< [states * DAE_LANES] each state at all times side by side */
    dae_state last; /**< a copy, with the discrete state that all have */
    double *values;
} gather;

/** @param waits  whether it waits for as many states as the kernel takes at once */
void gather_init(gather *gather, const wanted_outputs *wanted, bool waits);
void gather_free(gather *gather);

/** Put a state to those that it has, which have its discrete state. */
void gather_put(gather *gather, const dae_state *state, const output_mark *mark);
/** Put several, for which there is room. @param y  [states * DAE_LANES] of each state the times side by side */
void gather_put_several(gather *gather, int n, const double *t, const double *y, const dae_state *discrete);
/** Find what is wanted at the states that it has, and take leave of these.
 *  @param check  as of model_sampler_lanes. @return a dae_code; the block is valid until the next state comes */
int gather_find(gather *gather, bool check, output_block *block, char message[DAE_MESSAGE_LENGTH]);
/** Find it at DAE_LANES states that were not put, where there are none yet: nothing is copied. The block is valid as long as t. */
int gather_find_at(gather *gather, const double *t, const double *y, const dae_state *discrete, output_block *block,
                   char message[DAE_MESSAGE_LENGTH]);
