/** Periodic orbits of models that differ in one number: found, followed, told. docs/orbits.md. */
#pragma once

#include "model/model.h"

enum { MODEL_ORBIT_ROOT = 32 };

typedef enum {
    MODEL_ORBIT_ORDINARY,
    MODEL_ORBIT_FOLD,
    MODEL_ORBIT_CROSSING,
    MODEL_ORBIT_DOUBLING,
    MODEL_ORBIT_NEIMARK_SACKER,
    MODEL_ORBIT_TOUCH,
    MODEL_ORBIT_TOUCH_FOLD
} model_orbit_kind;

typedef struct {
    double parameter;
    double time;     /**< until it repeats [s] */
    double residual; /**< what is left after a period, in units of the states */
    int periods;     /**< common periods until it repeats */
    int kind;        /**< model_orbit_kind */
    int mesh;        /**< where flanks just touch; -1: nowhere */
    int iterations;
    int n_multipliers; /**< 0 of one that was told: it is as stable as its neighbours are */
    bool is_stable;
    bool whole_mesh;             /**< of a touch: no tooth pair of the mesh carries then; false: others do */
    int told;                    /**< the number that `tell` had of it; -1: it was not told */
    char root[MODEL_ORBIT_ROOT]; /**< what just touches there */
} model_orbit;

typedef struct {
    void *self;
    /** The model with a value of the parameter, until the next call; NULL with the reason in `message`. */
    const model *(*take)(void *self, double value, char message[DAE_MESSAGE_LENGTH]);
    /** Follow an orbit of that model once round for its numbers, and keep these under a number, in place of what was kept there: of a
     *  point that this call of model_orbits_advance may add, from 0.
     *  @param time   until it repeats [s]; where no speed is prescribed it becomes what it took
     *  @param state  on the section; becomes that at the end, taken back to the period where it began. @return whether it came round */
    bool (*tell)(void *self, int number, int periods, double *time, dae_state *state);
    double from, to; /**< range of the parameter */
    double place;    /**< of the section where a speed is prescribed [pitches of the first mesh after t = 0] */
    int n_values;
    const double
        *values; /**< [n_values] of the parameter, rising or falling, at which each branch has its stable orbits too */
} model_orbits_setup;

typedef struct model_orbits model_orbits;
/** @return NULL with the reason in `message` */
model_orbits *model_orbits_create(const model_orbits_setup *setup, double value, char message[DAE_MESSAGE_LENGTH]);
void model_orbits_delete(model_orbits **orbits);
/** Find an orbit, which becomes the present one, from a state near it. @param time  until it repeats, about [s].
 *  @return false with the reason in `message` */
bool model_orbits_find(model_orbits *orbits, double value, int periods, double time, const dae_state *near,
                       model_orbit *orbit, char message[DAE_MESSAGE_LENGTH]);
/** Stand at the first point of the branch of the present one. @param n  its points: one, or none. @return false with the reason in
 *  `message` */
bool model_orbits_begin(model_orbits *orbits, bool rising, int *n, char message[DAE_MESSAGE_LENGTH]);
/** Go on along it. @param n  its points, also where it fails. @return false with the reason in `message` */
bool model_orbits_advance(model_orbits *orbits, int *n, bool *is_over, char message[DAE_MESSAGE_LENGTH]);
/** How far the last branch was followed. */
typedef struct {
    double step;
    int crawls, n_ordinary;
    int before;    /**< which of its points, from 1, is the ordinary one before the last; 0: none */
    int is_smooth; /**< the cubic through its last two points told the last step better than the tangent */
} model_orbits_progress;
model_orbits_progress model_orbits_walk(const model_orbits *orbits);
/** How many numbers are kept of a point, so that another process goes on from there with the same bits. */
int model_orbits_kept(const model_orbits *orbits);
void model_orbits_keep(const model_orbits *orbits, int branch, int point, double *numbers);
/** Put down what was kept of the next point of a branch, or of the first of the next branch. @param numbers  NULL: that has no point */
void model_orbits_put(model_orbits *orbits, int branch, const double *numbers);
/** Stand at the last point of the last branch, whose points were put down. @return false with the reason in `message` */
bool model_orbits_go_on(model_orbits *orbits, const model_orbits_progress *progress, char message[DAE_MESSAGE_LENGTH]);
/** Make the first orbit of twice the period the present one. @return false with the reason in `message` */
bool model_orbits_switch(model_orbits *orbits, int branch, int point, char message[DAE_MESSAGE_LENGTH]);
/** @param multipliers  [2 * n_multipliers] of a point, real and imaginary parts; room for two a state and a real */
void model_orbits_point(const model_orbits *orbits, int branch, int point, model_orbit *orbit, double *multipliers);
/** The state of a point on the section, without y', or of the present one if `branch` is negative; take was asked for its model last.
 *  @return false with the reason in `message` */
bool model_orbits_state(model_orbits *orbits, int branch, int point, dae_state *state,
                        char message[DAE_MESSAGE_LENGTH]);
