/** Branches of periodic orbits over a parameter: the result of `evolvent respond --method orbits`. The interface is
 *  independent of HDF5; orbits_hdf5.c uses it. */
#pragma once

#include "base/status.h"
#include "files/history.h"
#include "model/model_orbits.h"

/** A point of a branch. */
typedef struct {
    int branch;
    int at_value; /**< index of its parameter among the requested values; -1: none */
    model_orbit orbit;
    double *multipliers; /**< [2 * n_multipliers] */
    double *values;      /**< [n_values] metrics; NULL: not available */
} orbit_point;

/** A branch: its points are contiguous. */
typedef struct {
    int parent;      /**< branch at whose period doubling it starts; -1: none */
    int n;           /**< number of points */
    const char *end; /**< reason of its end; "": at the end of the range */
} orbit_branch;

typedef struct {
    const char *path; /**< final name */
    const char *parameter, *units;
    const model_names *names;
    int n_harmonics, n_outputs, n_values;
    const model_output *outputs; /**< metrics of a point, with their offsets */
    int n_branches;
    const orbit_branch *branches;
    int n_points;
    const orbit_point *points;
    int n_attributes;
    const history_attribute *attributes; /**< of the root */
} orbit_branches;

/** Write it as NAME.partial; if `commit`, rename it to NAME. @return false with the reason in `error`, EVL_EXIT_IO */
bool orbits_write(const orbit_branches *orbits, bool commit, evl_error *error);
