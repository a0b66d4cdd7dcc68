/** What `evolvent show` tells of the geometry that follows from a case. */
#pragma once

#include "base/json.h"
#include "case/description.h"
#include "model/model.h"

#include <stdio.h>

/** In engineering units, each beside its number: of every wheel and mesh; then the real gears beside each other and the deviations,
 *  as ISO 21771 has them; then how the wheels of the meshes give way. */
void show_geometry(FILE *stream, const description *description, const model *model);
/** What makes the meshes too stiff, in one line without end; "" if nothing does. To be freed. */
char *stiffness_note(const description *description, const model *model);
/** The objects "wheels", "meshes", "deviations" and "compliance", by name, in SI units and radians. */
void write_geometry(json_writer *writer, const description *description, const model *model);
