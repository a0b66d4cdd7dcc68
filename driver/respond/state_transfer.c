#include "respond/state_transfer.h"

#include <math.h>

void state_transfer_free(state_transfer *c)
{
    dae_state_free(&c->state);
    c->exists = false;
}

void state_transfer_set(state_transfer *c, const section *section, const dae_state *at)
{
    const dae *dae = &model_about(section->model)->dae;
    const model_period *period = &section->period;
    if (!c->exists) {
        *c = (state_transfer){.exists = true, .sizes = *dae, .state = dae_state_create(dae, NULL)};
    }
    dae_state_copy(dae, &c->state, at);
    const int more = (int)floor(section_position(section, at) / period->pitches);
    model_take_back(section->model, period, more, &c->state);
    c->state.t = period->by_time ? at->t - more * period->time : 0;
    c->pitches = period->by_time ? section_position(section, &c->state) : 0;
    c->phase = section->phase;
}

void state_transfer_copy(state_transfer *to, const state_transfer *from)
{
    state_transfer_free(to);
    *to = *from;
    if (from->exists) {
        to->state = dae_state_create(&from->sizes, NULL);
        dae_state_copy(&from->sizes, &to->state, &from->state);
    }
}

double state_transfer_distance(const state_transfer *c, const model *model, const dae_state *state)
{
    dae_state there = c->state;
    there.integers = state->integers;
    there.reals = state->reals;
    return model_distance(model, state, &there);
}

void state_transfer_serialize(state_transfer *c, archive *archive)
{
    enum { MOST = 1000000 };
    int sizes[] = {c->sizes.n, c->sizes.n_integers, c->sizes.n_reals};
    bool exists = c->exists;
    SERIALIZE(archive, exists);
    SERIALIZE_ARRAY(archive, sizes, 3);
    if (archive->is_reading) {
        archive->has_failed = archive->has_failed || sizes[0] > MOST || sizes[1] > MOST || sizes[2] > MOST ||
                              sizes[0] < 0 || sizes[1] < 0 || sizes[2] < 0;
        state_transfer_free(c);
        c->exists = exists && !archive->has_failed;
    }
    if (!exists || archive->has_failed) {
        return; /* interrupted before the first motion: the next run starts as in the case */
    }
    if (archive->is_reading) {
        c->sizes = (dae){.n = sizes[0], .n_integers = sizes[1], .n_reals = sizes[2]};
        c->state = dae_state_create(&c->sizes, NULL);
    }
    SERIALIZE(archive, c->state.t);
    SERIALIZE_ARRAY(archive, c->state.y, c->sizes.n);
    SERIALIZE_ARRAY(archive, c->state.yp, c->sizes.n);
    SERIALIZE_ARRAY(archive, c->state.integers, c->sizes.n_integers);
    SERIALIZE_ARRAY(archive, c->state.reals, c->sizes.n_reals);
    SERIALIZE(archive, c->pitches);
    SERIALIZE(archive, c->phase);
}
