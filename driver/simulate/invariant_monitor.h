/** Monitor of the invariants of a run at its outputs: the inexpensive ones of `evolvent-post check`, with the same
 *  scales and bounds. */
#pragma once

#include "simulate/requested_outputs.h"

#include <stdbool.h>
#include <stddef.h>

typedef struct invariant_monitor invariant_monitor;

/** Create the monitor and request its outputs. @param tolerance  of the case, to which the bounds relate */
invariant_monitor *invariant_monitor_create(requested_outputs *requested, int n_wheels, int n_meshes, double tolerance);
void invariant_monitor_delete(invariant_monitor **monitor);
/** Serialise the monitor. */
void invariant_monitor_serialize(invariant_monitor *monitor, archive *archive);
/** Check a block; blocks are passed in order of time. */
void invariant_monitor_outputs(invariant_monitor *monitor, const output_block *block);
/** Largest error of the energy balance, relative to the energy put in or to the stored energy, whichever is larger; NaN
 *  if both are zero. */
double invariant_monitor_energy(const invariant_monitor *monitor);
/** "held", or "broken: " and the broken invariants with their errors.
 *  @return whether all held */
bool invariant_monitor_report(const invariant_monitor *monitor, char *text, size_t size);
