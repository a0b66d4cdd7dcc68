/** What `evolvent show` prints: a resolved case with its derived geometry, the laws, the keys of a case file. */
#ifndef EVOLVENT_SHOW_H
#define EVOLVENT_SHOW_H

#include "simulate/prepare.h"

#include <stdio.h>

/* Each returns EVL_EXIT_OK, or EVL_EXIT_IO if the stream could not be written. */

/** The resolved case, the derived geometry of every wheel and mesh, and the warnings, for reading. Of a case without a model the
 *  case alone. */
int show_text(FILE *stream, const prepared_case *prepared);
/** The same as one JSON object in SI units and radians, in full precision, for scripts.
 *  @param refusal  why the case cannot run, if so */
int show_json(FILE *stream, const prepared_case *prepared, const evl_error *refusal);
/** The laws of contact, damping and friction with their parameters (`evolvent show --laws`). */
int show_laws(FILE *stream, const law_tables *laws);
/** Every key of a case file with type, unit, range and default, as a Markdown reference (`evolvent show --keys`). */
int show_keys(FILE *stream, const law_tables *laws);

#endif
