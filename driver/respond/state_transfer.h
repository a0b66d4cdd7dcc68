/** Transfer of the state of a motion when the parameter changes. */
#pragma once

#include "base/archive.h"
#include "respond/section.h"

/** A state passed from one gearbox to the next, within one common period of the start. */
typedef struct {
    bool exists;
    dae sizes;       /**< of the original gearbox: only the numbers of states, integers and reals are used */
    dae_state state; /**< owns its arrays */
    double pitches;  /**< pitches of the first mesh until its time, with a prescribed speed */
    double phase;    /**< of the section */
} state_transfer;

void state_transfer_free(state_transfer *state_transfer);
/** Set it to a state on the section, shifted back into the first common period. @param at  a state of the section's
 *  model */
void state_transfer_set(state_transfer *state_transfer, const section *section, const dae_state *at);
/** Copy it. */
void state_transfer_copy(state_transfer *to, const state_transfer *from);
/** Distance of a state by its continuous states alone, in units of the scales; on the way to it contacts may differ. */
double state_transfer_distance(const state_transfer *state_transfer, const model *model, const dae_state *state);
/** Serialise it; when reading, the sizes are those that were stored. */
void state_transfer_serialize(state_transfer *state_transfer, archive *archive);
