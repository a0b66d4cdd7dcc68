/** Periodic orbits of a gearbox over one parameter, from the case to the result file. docs/guides/response.md. */
#pragma once

#include "respond/respond_options.h"

/** Find and write them. @return whether all are complete; else the reason is in `error`, and FILE.partial has the
 *  results so far */
bool respond_orbits(const respond_orbits_setup *setup, evl_error *error);
