/** The table of real gears that `evolvent show` prints: a column for each gear, a column for each mesh. */
#pragma once

#include "case/description.h"
#include "model/model.h"

#include <stdio.h>

/** Symbols of ISO 21771, lengths in mm, angles in degrees. Prints nothing if the case has no real gears. */
void show_gears(FILE *stream, const description *description, const model *model);
