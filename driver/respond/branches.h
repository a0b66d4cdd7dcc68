/** Branches of periodic orbits: from settled motions of a gearbox along the parameter, through folds, and onwards from
 *  period doublings. */
#pragma once

#include "files/orbits.h"
#include "respond/branch.h"

/** Next task. */
typedef enum { BRANCHES_LOOK, BRANCHES_RISE, BRANCHES_FALL, BRANCHES_DOUBLE } branches_task;

typedef struct {
    branch *sweep; /**< prepares the case, and finds settled motions to start from */
    int n_values;  /**< evenly spaced values, from first to last, with stable orbits required, too; 0: none */
    memory_pool pool;
    model_orbits *orbits;
    prepared_case prepared; /**< for the last call by the kernel */
    model_period period;    /**< of the same */
    int longest;            /**< largest length of an orbit in common periods */
    double *values;         /**< [n_values] */
    int n_told;             /**< orbits recorded by the kernel's callback in the last step of a branch; their */
    double **told;          /**< [n_told] metrics */
    /* serialised members */
    int value;                      /**< index in the range of the value at which branches are searched now */
    int task;                       /**< branches_task */
    int doubling;                   /**< point at which a period doubling is checked next */
    bool is_under_way;              /**< the continuation of the last branch is in progress */
    model_orbits_progress progress; /**< of that continuation */
    carried motion;                 /**< settled motion at the value */
    response_point at;              /**< period and time of that motion */
    bool has_orbits;                /**< there are orbits; their scales are those at */
    double scaled_at;               /**< this value */
    double place;                   /**< position of the section [pitches] */
    dae sizes;                      /**< only the numbers of states, integers and reals are used */
    int n_branches, n_points;
    orbit_branch *branches;
    orbit_point *points;
    int n_kept;
    double **kept; /**< [n_points][n_kept] data of the points for the kernel */
    int n_problems;
    const char **problems; /**< attempts that did not converge to an orbit */
} branches;

/** Whether all branches are complete. */
bool branches_are_done(const branches *branches);
/** Do the next task: search a settled motion, start a branch, or find its next point.
 *  @return ORBIT_FAILED with the reason in `error`; then, and after an interrupt, the task remains to be done */
orbit_end branches_step(branches *branches, evl_error *error);
/** Serialise all that a later step needs. */
void branches_keep(branches *branches, archive *archive);
/** Restore the serialised data in the kernel. @return false with the reason in `error` */
bool branches_resume(branches *branches, evl_error *error);
void branches_free(branches *branches);
