#include "simulate/output_buffer.h"

#include <string.h>

void output_buffer_init(output_buffer *output_buffer, const requested_outputs *requested, bool waits)
{
    const dae *dae = &model_about(requested->model)->dae;
    *output_buffer = (struct output_buffer){.requested = requested, .capacity = waits ? DAE_LANES : 1};
    memory_arena *arena = &output_buffer->arena;
    output_buffer->last = dae_state_create(dae, arena);
    output_buffer->values = arena_calloc(arena, (size_t)requested->n_values * DAE_LANES, sizeof *output_buffer->values);
    output_buffer->y = arena_calloc(arena, (size_t)dae->n * DAE_LANES, sizeof *output_buffer->y);
    output_buffer->sampler = model_sampler_create(requested->model, requested->n, requested->outputs);
}

void output_buffer_free(output_buffer *output_buffer)
{
    model_sampler_delete(&output_buffer->sampler);
    arena_free(&output_buffer->arena);
}

/** Store the common discrete state. */
static void take_discrete(output_buffer *output_buffer, const dae_state *discrete)
{
    const dae *dae = &model_about(output_buffer->requested->model)->dae;
    if (output_buffer->n == 0) {
        memcpy(output_buffer->last.integers, discrete->integers, (size_t)dae->n_integers * sizeof(int));
        memcpy(output_buffer->last.reals, discrete->reals, (size_t)dae->n_reals * sizeof(double));
    }
}

void output_buffer_add_several(output_buffer *output_buffer, int n, const double *t, const double *y,
                               const dae_state *discrete)
{
    const int n_states = model_about(output_buffer->requested->model)->dae.n;
    take_discrete(output_buffer, discrete);
    for (int i = 0; i < n_states; i++) {
        memcpy(output_buffer->y + i * DAE_LANES + output_buffer->n, y + i * DAE_LANES, (size_t)n * sizeof *y);
    }
    memcpy(output_buffer->t + output_buffer->n, t, (size_t)n * sizeof *t);
    output_buffer->n += n;
}

void output_buffer_add(output_buffer *output_buffer, const dae_state *state, const output_mark *mark)
{
    const int n = model_about(output_buffer->requested->model)->dae.n;
    double *y = output_buffer->y + output_buffer->n;
    for (int i = 0; i < n; i++) {
        y[i * DAE_LANES] = state->y[i];
    }
    take_discrete(output_buffer, state);
    output_buffer->has_marks = mark != NULL;
    if (mark != NULL) {
        output_buffer->marks[output_buffer->n] = *mark;
    }
    output_buffer->t[output_buffer->n++] = state->t;
}

int output_buffer_evaluate(output_buffer *output_buffer, bool check, output_block *block,
                           char message[DAE_MESSAGE_LENGTH])
{
    *block = (output_block){.n = output_buffer->n,
                            .t = output_buffer->t,
                            .values = output_buffer->values,
                            .marks = output_buffer->has_marks ? output_buffer->marks : NULL};
    output_buffer->n = 0;
    return model_sampler_lanes(output_buffer->sampler, block->n, check, output_buffer->t, output_buffer->y,
                               &output_buffer->last, output_buffer->values, message);
}

int output_buffer_evaluate_at(output_buffer *output_buffer, const double *t, const double *y, const dae_state *discrete,
                              output_block *block, char message[DAE_MESSAGE_LENGTH])
{
    *block = (output_block){.n = DAE_LANES, .t = t, .values = output_buffer->values};
    return model_sampler_lanes(output_buffer->sampler, DAE_LANES, true, t, y, discrete, output_buffer->values, message);
}
