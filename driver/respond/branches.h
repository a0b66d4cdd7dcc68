/** Branches of periodic orbits: from motions that a gearbox comes to, along the parameter, through folds, and on from doublings. */
#pragma once

#include "files/orbits.h"
#include "respond/branch.h"

typedef struct {
    branch *sweep; /**< prepares the case, and finds motions to begin with */
    int n_values;  /**< of the range, evenly from its first to its last, at which there are to be orbits too; 0: none */
    memory_pool pool;
    model_orbits *orbits;
    prepared_case prepared; /**< what the orbits were asked about last */
    model_period period;    /**< of that */
    double *values;         /**< [n_values] */
    double place;           /**< of the section [pitches] */
    dae sizes;              /**< only numbers of states, integers and reals count */
    int n_branches, n_points;
    orbit_branch *branches;
    orbit_point *points;
    int n_problems;
    const char **problems;                      /**< what was tried and did not come to an orbit */
    void (*told)(void *self, const char *what); /**< what is being done */
    void *self;
} branches;

/** Find all: a motion at each value of the range that is on no branch begins one.
 *  @return ORBIT_FAILED with the reason in `error` if there is none; what is found so far stays */
orbit_end branches_find(branches *branches, evl_error *error);
void branches_free(branches *branches);
