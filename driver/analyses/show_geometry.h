/** Geometry of a case as printed by `evolvent show`. */
#pragma once

#include "base/json.h"
#include "case/description.h"
#include "model/model.h"

#include <stdio.h>

/** Print tables in engineering units: every wheel and mesh; then the gears with a basic rack and their deviations, as
 *  in ISO 21771; then the compliance of the gears. */
void show_geometry(FILE *stream, const description *description, const model *model);
/** What makes the meshes too stiff, in one line without end; "" if nothing does. To be freed. */
char *stiffness_note(const description *description, const model *model);
/** The objects "wheels", "meshes", "deviations" and "compliance", by name, in SI units and radians. */
void write_geometry(json_writer *writer, const description *description, const model *model);
