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
} carried;

void carried_free(carried *carried);
/** Set it to a state on the section, shifted back into the first common period. @param at  a state of the section's
 *  model */
void carried_set(carried *carried, const section *section, const dae_state *at);
/** Copy it. */
void carried_copy(carried *to, const carried *from);
/** Distance of a state by its continuous states alone, in units of the scales; on the way to it contacts may differ. */
double carried_distance(const carried *carried, const model *model, const dae_state *state);
/** Serialise it; when reading, the sizes are those that were stored. */
void carried_keep(carried *carried, archive *archive);
