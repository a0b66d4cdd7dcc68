/** Selection of outputs by their names or by the names of groups. */
#pragma once

#include "model/model.h"

#include <stdbool.h>

/** All groups. */
#define OUTPUT_GROUPS                                                                                                  \
    "all gearbox wheels meshes pairs shafts bearings housing accelerometers energies losses forces tracking "          \
    "check"

/** Select outputs that change over time, by their names or those of their groups, separated by commas or blanks.
 *  @param chosen  [n] of these outputs; constants, which every history has, may be named and are not selected
 *  @return NULL, or the reason why a word is unknown, with a suggestion: a new string */
char *output_groups_choose(const char *words, int n, const model_output *outputs, bool *chosen);
