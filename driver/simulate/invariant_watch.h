/** Whether a run keeps its own invariants, seen at its outputs: the cheap ones of `evolvent-post check`, with the same scales and
 *  bounds. */
#pragma once

#include "simulate/wanted.h"

#include <stdbool.h>
#include <stddef.h>

typedef struct invariant_watch invariant_watch;

/** Wants what it looks at. @param tolerance  of the case, to which the bounds relate */
invariant_watch *invariant_watch_create(wanted_outputs *wanted, int n_wheels, int n_meshes, double tolerance);
void invariant_watch_delete(invariant_watch **watch);
/** Keep what was seen. */
void invariant_watch_keep(invariant_watch *watch, archive *archive);
/** The blocks come in order of time. */
void invariant_watch_outputs(invariant_watch *watch, const output_block *block);
/** Largest error of the energy balance over the energy that was put in, or that was there if that is more; NaN if there was
 *  none. */
double invariant_watch_energy(const invariant_watch *watch);
/** "held", or "broken: " and what is broken by how much.
 *  @return whether all held */
bool invariant_watch_tell(const invariant_watch *watch, char *text, size_t size);
