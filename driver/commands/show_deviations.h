/** What `evolvent show` prints of the deviations of flanks. */
#pragma once

#include "base/json.h"
#include "case/description.h"
#include "model/model.h"

#include <stdio.h>

/** A table for each wheel that has any: lengths in mm, angles in degrees, pitch errors in um. */
void show_deviations(FILE *stream, const description *description, const model *model);
/** The object "deviations": by name of the wheel, in SI units and radians; empty if there are none. */
void write_deviations(json_writer *writer, const description *description, const model *model);
