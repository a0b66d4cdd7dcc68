/** How the wheels of each mesh give way, for `evolvent show`. */
#ifndef EVOLVENT_SHOW_COMPLIANCE_H
#define EVOLVENT_SHOW_COMPLIANCE_H

#include "base/json.h"
#include "case/description.h"
#include "model/model.h"

#include <stdio.h>

/** A table for each mesh one of whose wheels gives way. */
void show_compliance(FILE *stream, const description *description, const model *model);
/** The same as the object "compliance", in SI units. */
void write_compliance(json_writer *writer, const description *description, const model *model);

#endif
