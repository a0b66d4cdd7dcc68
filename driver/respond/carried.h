/** The state with which a motion goes on when the parameter changes. */
#pragma once

#include "base/archive.h"
#include "respond/section.h"

/** A state that goes from one gearbox to the next: it lies within one common period of the start. */
typedef struct {
    bool exists;
    dae sizes;       /**< of the gearbox that it was of: only numbers of states, integers and reals count */
    dae_state state; /**< its arrays belong to it */
    double pitches;  /**< of the first mesh to its time, where a speed is prescribed */
    double phase;    /**< of the section */
} carried;

void carried_free(carried *carried);
/** Make it a state on the section, taken back into the first common period. @param at  it is of the section's model */
void carried_set(carried *carried, const section *section, const dae_state *at);
/** Make one that of another. */
void carried_copy(carried *to, const carried *from);
/** Distance of a state by its states alone, in units of the scales: contacts may be others on the way to it. */
double carried_distance(const carried *carried, const model *model, const dae_state *state);
/** Keep it; of one that is read the sizes are those that were kept. */
void carried_keep(carried *carried, archive *archive);
