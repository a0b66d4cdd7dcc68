/** Buffer of states at which outputs are due, evaluated together by the kernel. */
#pragma once

#include "simulate/requested_outputs.h"

typedef struct output_buffer {
    memory_arena arena;
    const requested_outputs *requested;
    model_sampler *sampler;
    int capacity; /**< states in a full buffer */
    int n;        /**< states in the buffer */
    double t[DAE_LANES];
    output_mark marks[DAE_LANES];
    bool has_marks;
    double *y;      /**< [states * DAE_LANES] for each state variable the values at all times */
    dae_state last; /**< a copy, with the common discrete state */
    double *values;
} output_buffer;

/** @param waits  whether to collect as many states as the kernel evaluates together */
void output_buffer_init(output_buffer *output_buffer, const requested_outputs *requested, bool waits);
void output_buffer_free(output_buffer *output_buffer);

/** Add a state; all buffered states have the same discrete state. */
void output_buffer_add(output_buffer *output_buffer, const dae_state *state, const output_mark *mark);
/** Add several states, for which there must be space. @param y  [states * DAE_LANES] for each state variable the values
 *  at all times */
void output_buffer_add_several(output_buffer *output_buffer, int n, const double *t, const double *y,
                               const dae_state *discrete);
/** Evaluate the requested outputs at the buffered states, then clear the buffer.
 *  @param check  as in model_sampler_lanes. @return a dae_code; the block is valid until the next state is added */
int output_buffer_evaluate(output_buffer *output_buffer, bool check, output_block *block,
                           char message[DAE_MESSAGE_LENGTH]);
/** Evaluate the outputs at DAE_LANES given states while the buffer is empty, without copying. The block is valid as
 *  long as t. */
int output_buffer_evaluate_at(output_buffer *output_buffer, const double *t, const double *y, const dae_state *discrete,
                              output_block *block, char message[DAE_MESSAGE_LENGTH]);
