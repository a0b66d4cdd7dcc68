/** Motions of a gearbox over one parameter that goes up and down in steps: the motion at a value begins where that of the value
 *  before ended. docs/response.md. */
#pragma once

#include "base/status.h"

#include <stdbool.h>

typedef struct {
    const char *over; /**< PATH=FROM:TO[:STEPS] */
    bool up, down;
    int most;             /**< common periods at a value; 0: the usual number */
    const char *path;     /**< of the result */
    const char *versions; /**< of all that made it */
    int n_set;
    const char *const *set;
    bool quiet;
} respond_options;

/** @return the exit code, with the reason in `error` */
evl_exit respond(const char *case_path, const respond_options *options, evl_error *error);
