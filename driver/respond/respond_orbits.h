/** Periodic orbits of a gearbox over one parameter, from the case to the result file. docs/guides/response.md. */
#pragma once

#include "respond/branch.h"
#include "respond/going_on.h"
#include "respond/respond.h"

typedef struct respond_orbits_setup {
    branch *sweep;              /**< the case over its range */
    const prepared_case *first; /**< at its first value */
    going_on *going_on;         /**< its folder is open; its content is set here */
    const char *unit, *warnings;
    const respond_options *options;
} respond_orbits_setup;

/** Find and write them. @return whether all are complete; else the reason is in `error`, and FILE.partial has the
 *  results so far */
bool respond_orbits(const respond_orbits_setup *setup, evl_error *error);
