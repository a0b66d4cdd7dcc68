/** The table of real gears that `evolvent show` prints: a column for each gear, a column for each mesh. */
#ifndef EVOLVENT_SHOW_GEARS_H
#define EVOLVENT_SHOW_GEARS_H

#include "case/description.h"
#include "model/model.h"

#include <stdio.h>

/** Symbols of ISO 21771, lengths in mm, angles in degrees. Prints nothing if the case has no real gears. */
void show_gears(FILE *stream, const description *description, const model *model);

#endif
