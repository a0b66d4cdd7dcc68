/** Buffer of states at which outputs are due, evaluated together by the kernel. */
#pragma once

#include "simulate/wanted.h"

typedef struct gather {
    memory_pool pool;
    const wanted_outputs *wanted;
    model_sampler *sampler;
    int capacity; /**< states in a full buffer */
    int n;        /**< states in the buffer */
    double t[DAE_LANES];
    output_mark marks[DAE_LANES];
    bool has_marks;
    double *y;      /**< [states * DAE_LANES] for each state variable the values at all times */
    dae_state last; /**< a copy, with the common discrete state */
    double *values;
} gather;

/** @param waits  whether to collect as many states as the kernel evaluates together */
void gather_init(gather *gather, const wanted_outputs *wanted, bool waits);
void gather_free(gather *gather);

/** Add a state; all buffered states have the same discrete state. */
void gather_put(gather *gather, const dae_state *state, const output_mark *mark);
/** Add several states, for which there must be space. @param y  [states * DAE_LANES] for each state variable the values
 *  at all times */
void gather_put_several(gather *gather, int n, const double *t, const double *y, const dae_state *discrete);
/** Evaluate the requested outputs at the buffered states, then clear the buffer.
 *  @param check  as in model_sampler_lanes. @return a dae_code; the block is valid until the next state is added */
int gather_find(gather *gather, bool check, output_block *block, char message[DAE_MESSAGE_LENGTH]);
/** Evaluate the outputs at DAE_LANES given states while the buffer is empty, without copying. The block is valid as
 *  long as t. */
int gather_find_at(gather *gather, const double *t, const double *y, const dae_state *discrete, output_block *block,
                   char message[DAE_MESSAGE_LENGTH]);
