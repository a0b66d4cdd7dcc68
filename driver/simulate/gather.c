#include "simulate/gather.h"

#include <string.h>

void gather_init(gather *gather, const wanted_outputs *wanted, bool waits)
{
    const dae *dae = &model_about(wanted->model)->dae;
    *gather = (struct gather){.wanted = wanted, .capacity = waits ? DAE_LANES : 1};
    memory_pool *pool = &gather->pool;
    gather->last = dae_state_create(dae, pool);
    gather->values = pool_calloc(pool, (size_t)wanted->n_values * DAE_LANES, sizeof *gather->values);
    gather->y = pool_calloc(pool, (size_t)dae->n * DAE_LANES, sizeof *gather->y);
    gather->sampler = model_sampler_create(wanted->model, wanted->n, wanted->outputs);
}

void gather_free(gather *gather)
{
    model_sampler_delete(&gather->sampler);
    pool_free(&gather->pool);
}

/** Store the common discrete state. */
static void take_discrete(gather *gather, const dae_state *discrete)
{
    const dae *dae = &model_about(gather->wanted->model)->dae;
    if (gather->n == 0) {
        memcpy(gather->last.integers, discrete->integers, (size_t)dae->n_integers * sizeof(int));
        memcpy(gather->last.reals, discrete->reals, (size_t)dae->n_reals * sizeof(double));
    }
}

void gather_put_several(gather *gather, int n, const double *t, const double *y, const dae_state *discrete)
{
    const int n_states = model_about(gather->wanted->model)->dae.n;
    take_discrete(gather, discrete);
    for (int i = 0; i < n_states; i++) {
        memcpy(gather->y + i * DAE_LANES + gather->n, y + i * DAE_LANES, (size_t)n * sizeof *y);
    }
    memcpy(gather->t + gather->n, t, (size_t)n * sizeof *t);
    gather->n += n;
}

void gather_put(gather *gather, const dae_state *state, const output_mark *mark)
{
    const int n = model_about(gather->wanted->model)->dae.n;
    double *y = gather->y + gather->n;
    for (int i = 0; i < n; i++) {
        y[i * DAE_LANES] = state->y[i];
    }
    take_discrete(gather, state);
    gather->has_marks = mark != NULL;
    if (mark != NULL) {
        gather->marks[gather->n] = *mark;
    }
    gather->t[gather->n++] = state->t;
}

int gather_find(gather *gather, bool check, output_block *block, char message[DAE_MESSAGE_LENGTH])
{
    *block = (output_block){
        .n = gather->n, .t = gather->t, .values = gather->values, .marks = gather->has_marks ? gather->marks : NULL};
    gather->n = 0;
    return model_sampler_lanes(gather->sampler, block->n, check, gather->t, gather->y, &gather->last, gather->values,
                               message);
}

int gather_find_at(gather *gather, const double *t, const double *y, const dae_state *discrete, output_block *block,
                   char message[DAE_MESSAGE_LENGTH])
{
    *block = (output_block){.n = DAE_LANES, .t = t, .values = gather->values};
    return model_sampler_lanes(gather->sampler, DAE_LANES, true, t, y, discrete, gather->values, message);
}
