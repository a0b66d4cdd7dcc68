/** Branches of periodic orbits: from motions that a gearbox comes to, along the parameter, through folds, and on from doublings. */
#pragma once

#include "files/orbits.h"
#include "respond/branch.h"

/** What is done next. */
typedef enum { BRANCHES_LOOK, BRANCHES_RISE, BRANCHES_FALL, BRANCHES_DOUBLE } branches_task;

typedef struct {
    branch *sweep; /**< prepares the case, and finds motions to begin with */
    int n_values; /**< of the range, evenly from its first to its last, at which there are to be stable orbits too; 0: none */
    memory_pool pool;
    model_orbits *orbits;
    prepared_case prepared; /**< what the orbits were asked about last */
    model_period period;    /**< of that */
    int longest;            /**< common periods of an orbit at most */
    double *values;         /**< [n_values] */
    int n_told;             /**< orbits that the kernel let be told in the last step of a branch; their */
    double **told;          /**< [n_told] numbers */
    /* what is kept */
    int value;                      /**< place in the range, from which branches are sought now */
    int task;                       /**< branches_task */
    int doubling;                   /**< point at which a doubling is looked for next */
    bool is_under_way;              /**< the last branch is being followed */
    model_orbits_progress progress; /**< along that */
    carried motion;                 /**< to which the gearbox comes at the value */
    response_point at;              /**< of that: its period and time count */
    bool has_orbits;                /**< there are orbits, whose scales are those of */
    double scaled_at;               /**< this value */
    double place;                   /**< of the section [pitches] */
    dae sizes;                      /**< only numbers of states, integers and reals count */
    int n_branches, n_points;
    orbit_branch *branches;
    orbit_point *points;
    int n_kept;
    double **kept; /**< [n_points][n_kept] what the kernel needs of them */
    int n_problems;
    const char **problems; /**< what was tried and did not come to an orbit */
} branches;

/** Whether all is found. */
bool branches_are_done(const branches *branches);
/** Do the next thing: look for a motion to begin with, begin a branch, or find its next point.
 *  @return ORBIT_FAILED with the reason in `error`; then, and when it was interrupted, it is still to be done */
orbit_end branches_step(branches *branches, evl_error *error);
/** Keep all that a later step needs. */
void branches_keep(branches *branches, archive *archive);
/** Make what was kept known to the kernel. @return false with the reason in `error` */
bool branches_resume(branches *branches, evl_error *error);
void branches_free(branches *branches);
