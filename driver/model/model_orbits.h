/** Periodic orbits of models that differ in one number: search, continuation, results. docs/theory/orbits.md. */
#pragma once

#include "model/model.h"

enum { MODEL_ORBIT_ROOT = 32 };

typedef enum {
    MODEL_ORBIT_ORDINARY,
    MODEL_ORBIT_FOLD,
    MODEL_ORBIT_CROSSING,
    MODEL_ORBIT_DOUBLING,
    MODEL_ORBIT_NEIMARK_SACKER,
    MODEL_ORBIT_GRAZING,
    MODEL_ORBIT_GRAZING_FOLD
} model_orbit_kind;

typedef struct {
    double parameter;
    double time;     /**< period [s] */
    double residual; /**< difference after a period, in units of the states */
    int periods;     /**< its length in common periods */
    int kind;        /**< model_orbit_kind */
    int mesh;        /**< mesh with grazing contact; -1: none */
    int iterations;
    int n_multipliers; /**< 0 if recorded by `record`: its stability is that of its neighbours */
    bool is_stable;
    bool whole_mesh;             /**< of grazing: no tooth pair of the mesh is loaded then; false: others are */
    int recorded;                /**< index under which `record` stored the metrics; -1: not recorded */
    char root[MODEL_ORBIT_ROOT]; /**< root function that is grazing */
} model_orbit;

typedef struct {
    void *self;
    /** The model for a value of the parameter, valid until the next call; NULL with the reason in `message`. */
    const model *(*take)(void *self, double value, char message[DAE_MESSAGE_LENGTH]);
    /** Integrate an orbit of that model over one period for its metrics, and store these under an index, replacing
     *  earlier ones: of a point that the present model_orbits_advance may add, from 0.
     *  @param time   period [s]; without a prescribed speed it is updated
     *  @param state  on the section; becomes the final one, shifted back to the period of its start. @return whether
     *                the integration succeeded */
    bool (*record)(void *self, int number, int periods, double *time, dae_state *state);
    double from, to; /**< range of the parameter */
    double position; /**< position of the section with a prescribed speed [pitches of the first mesh after t = 0] */
    int n_values;
    const double *values; /**< [n_values] of the parameter, monotonic, at which stable orbits are required, too */
} model_orbits_setup;

typedef struct model_orbits model_orbits;
/** @return NULL with the reason in `message` */
model_orbits *model_orbits_create(const model_orbits_setup *setup, double value, char message[DAE_MESSAGE_LENGTH]);
void model_orbits_delete(model_orbits **orbits);
/** Find an orbit near a state and make it the present one. @param time  approximate period [s].
 *  @return false with the reason in `message` */
bool model_orbits_find(model_orbits *orbits, double value, int periods, double time, const dae_state *near,
                       model_orbit *orbit, char message[DAE_MESSAGE_LENGTH]);
/** Start at the first point of the branch of the present orbit. @param n  its points: one, or none. @return false with
 *  the reason in `message` */
bool model_orbits_begin(model_orbits *orbits, bool rising, int *n, char message[DAE_MESSAGE_LENGTH]);
/** Advance along the branch. @param n  its points, also on failure. @return false with the reason in `message` */
bool model_orbits_advance(model_orbits *orbits, int *n, bool *is_over, char message[DAE_MESSAGE_LENGTH]);
/** State of the continuation of the last branch. */
typedef struct {
    double step;
    int crawls, n_ordinary;
    int before;    /**< index, from 1, of the ordinary point before the last one; 0: none */
    int is_smooth; /**< the cubic through its last two points predicted the last step better than the tangent */
} model_orbits_progress;
model_orbits_progress model_orbits_walk(const model_orbits *orbits);
/** Number of values stored for a point, from which another process continues with bitwise the same results. */
int model_orbits_record_length(const model_orbits *orbits);
void model_orbits_save(const model_orbits *orbits, int branch, int point, double *numbers);
/** Restore the stored values of the next point of a branch, or of the first point of the next branch. @param numbers
 *  NULL: there are none for the point */
void model_orbits_put(model_orbits *orbits, int branch, const double *numbers);
/** Continue at the last point of the last branch after its points were restored. @return false with the reason in
 *  `message` */
bool model_orbits_go_on(model_orbits *orbits, const model_orbits_progress *progress, char message[DAE_MESSAGE_LENGTH]);
/** Make the first orbit of the period-doubled branch the present one. @return false with the reason in `message` */
bool model_orbits_switch(model_orbits *orbits, int branch, int point, char message[DAE_MESSAGE_LENGTH]);
/** @param multipliers  [2 * n_multipliers] of a point, real and imaginary parts; space for two per state and real
 *                      number */
void model_orbits_point(const model_orbits *orbits, int branch, int point, model_orbit *orbit, double *multipliers);
/** The state of a point on the section, without y', or of the present orbit if `branch` is negative; the last call of
 *  `take` was for its model.
 *  @return false with the reason in `message` */
bool model_orbits_state(model_orbits *orbits, int branch, int point, dae_state *state,
                        char message[DAE_MESSAGE_LENGTH]);
