/** Names of outputs, and of groups of them, by which they are chosen. */
#pragma once

#include "model/model.h"

#include <stdbool.h>

/** All groups. */
#define OUTPUT_GROUPS                                                                                                  \
    "all gearbox wheels meshes pairs shafts bearings housing accelerometers energies losses forces tracking "          \
    "check"

/** Choose outputs that change over time, by their names or those of their groups, between commas or blanks.
 *  @param chosen  [n] of these outputs; constants, which every history has, may be named and are not chosen
 *  @return NULL, or why a word is none, with what was meant: a new string */
char *output_groups_choose(const char *words, int n, const model_output *outputs, bool *chosen);
