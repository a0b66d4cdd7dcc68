/** Points of branches with their metrics, failed attempts, and tests whether an orbit is already on a branch. */
#pragma once

#include "files/orbits.h"
#include "respond/branch.h"

/** Next task. */
typedef enum { BRANCHES_LOOK, BRANCHES_RISE, BRANCHES_FALL, BRANCHES_DOUBLE } branches_task;

typedef struct {
    branch *sweep; /**< prepares the case, and finds settled motions to start from */
    int n_values;  /**< evenly spaced values, from first to last, with stable orbits required, too; 0: none */
    memory_arena arena;
    model_orbits *orbits;
    case_plan plan;      /**< for the last call by the kernel */
    model_period period; /**< of the same */
    int longest;         /**< largest length of an orbit in common periods */
    double *values;      /**< [n_values] */
    int n_recorded;      /**< orbits recorded by the kernel's callback in the last step of a branch; their */
    double **recorded;   /**< [n_recorded] metrics */
    /* serialised members */
    int value;                      /**< index in the range of the value at which branches are searched now */
    int task;                       /**< branches_task */
    int doubling;                   /**< point at which a period doubling is checked next */
    bool is_continuing;             /**< the continuation of the last branch is in progress */
    model_orbits_progress progress; /**< of that continuation */
    state_transfer motion;          /**< settled motion at the value */
    response_point at;              /**< period and time of that motion */
    bool has_orbits;                /**< there are orbits; their scales are those at */
    double scaled_at;               /**< this value */
    double position;                /**< position of the section [pitches] */
    dae sizes;                      /**< only the numbers of states, integers and reals are used */
    int n_branches, n_points;
    orbit_branch *branches;
    orbit_point *points;
    int record_length;
    double **records; /**< [n_points][record_length] data of the points for the kernel */
    int n_problems;
    const char **problems; /**< attempts that did not converge to an orbit */
} branches;

/** Process the new points of the last branch, and store the kernel's data of them. @param n  its present number of
 *  points */
void branches_take_points(branches *branches, int n);
/** Record an attempt that did not converge to an orbit. */
void branches_note(branches *branches, double value, const char *why);
/** Metrics of the present orbit. @return NULL if a run departs from it */
double *branches_metrics(branches *branches, const model_orbit *orbit);
/** Whether a branch passes through an orbit with these metrics. */
bool branches_pass(branches *branches, double value, int periods, const double *values);
/** Whether a period-doubled branch starts or ends at a doubling. */
bool branches_have_entered(const branches *branches, const model_orbit *doubling);
/** Number of requested values that stable orbits of a branch pass without a point. @param first  the first of these
 *  values */
int branches_left_out(const branches *branches, int branch, double *first);
