/** Periodic orbits of a gearbox over one parameter, from a case to a file. docs/response.md. */
#pragma once

#include "respond/branch.h"
#include "respond/going_on.h"
#include "respond/respond.h"

typedef struct respond_orbits_setup {
    branch *sweep;              /**< the case over its range */
    const prepared_case *first; /**< at its first value */
    going_on *going_on;         /**< its folder is open; what it keeps is set here */
    const char *unit, *warnings;
    const respond_options *options;
} respond_orbits_setup;

/** Find them and write them. @return whether it is done; else the reason is in `error`, and FILE.partial has what was found */
bool respond_orbits(const respond_orbits_setup *setup, evl_error *error);
