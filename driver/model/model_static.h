/** Quasi-static analysis of a mesh under torques on its driving wheel (loaded tooth contact analysis). */
#pragma once

#include "model/model.h"

/** Layout of the results: a cycle of positions, and the outputs for each torque. */
typedef struct {
    int mesh, points;        /**< points: positions per pitch */
    int n_pitches;           /**< of a cycle */
    int n_positions;         /**< position i is i/points pitches from the start of contact of tooth pair 0 */
    int n_pairs, first_pair; /**< tooth pairs, numbered by the pitches by which they lead the last pair to enter */
    int n_wheels;            /**< with root stress: driving and driven wheel; 0: none */
    int n_harmonics;         /**< numbered from 1 */
    double torque;           /**< at the nominal operating point, < 0 on the coast flanks [N m]; 0: no load */
    double speed;            /**< of the driving wheel, for friction: the caller's [rad/s] */
    int n_values, n_outputs;
    const model_output *outputs; /**< [n_outputs] dims: words of "position", "pair", "harmonic", "wheel" */
    void *texts;                 /**< of the outputs */
} static_plan;

/** Whether a message concerns the requested points or torque, not the case. */
bool model_is_of_request(const model_message *message);
/** @return false with the reason in `error`; free the plan in any case */
bool model_plan_static(const model *model, int mesh, int points, static_plan *plan, model_message *error);
void static_plan_free(static_plan *plan);
/** All values at a torque [N m], [n_values]. @return false with the reason in `error` */
bool model_static(const model *model, const static_plan *plan, double torque, double *values, model_message *error);
/** Load of a mesh while it moves from one position to another. */
typedef struct {
    double from, to; /**< [pitches] */
    double torque;   /**< of the driving wheel [N m] */
} static_span;
/** Largest force of a tooth pair in static equilibrium [N]. @return NAN where the analysis does not apply */
double model_static_pair_force(const model *model, int mesh, const static_span *span);
/** Largest root stress of a wheel in static equilibrium [Pa]. @param spans  of all meshes. @return NAN as above */
double model_static_root(const model *model, int wheel, const static_span *spans);
