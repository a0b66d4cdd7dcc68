/** Monitor of the invariants of a run at its outputs: the inexpensive ones of `evolvent-post check`, with the same
 *  scales and bounds. */
#pragma once

#include "simulate/wanted.h"

#include <stdbool.h>
#include <stddef.h>

typedef struct invariant_watch invariant_watch;

/** Create the monitor and request its outputs. @param tolerance  of the case, to which the bounds relate */
invariant_watch *invariant_watch_create(wanted_outputs *wanted, int n_wheels, int n_meshes, double tolerance);
void invariant_watch_delete(invariant_watch **watch);
/** Serialise the monitor. */
void invariant_watch_keep(invariant_watch *watch, archive *archive);
/** Check a block; blocks are passed in order of time. */
void invariant_watch_outputs(invariant_watch *watch, const output_block *block);
/** Largest error of the energy balance, relative to the energy put in or to the stored energy, whichever is larger; NaN
 *  if both are zero. */
double invariant_watch_energy(const invariant_watch *watch);
/** "held", or "broken: " and the broken invariants with their errors.
 *  @return whether all held */
bool invariant_watch_tell(const invariant_watch *watch, char *text, size_t size);
