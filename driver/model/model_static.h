/** The static analysis of a mesh: at rest under torques of its driving wheel. */
#pragma once

#include "model/model.h"

/** What it comes to: a cycle of positions, and what is told of each torque. */
typedef struct {
    int mesh, points; /**< points: positions a pitch */
    int n_pitches;    /**< of a cycle */
    int n_positions;  /**< position i is i/points pitches from where tooth pair 0 is at the start of contact */
    int n_pairs,
        first_pair;  /**< places for tooth pairs, by how many pitches they are ahead of the one that came last */
    int n_harmonics; /**< numbered from 1 */
    double torque;   /**< at the nominal operating point, < 0 on the coast flanks [N m]; 0: no load */
    double speed;    /**< of the driving wheel, for friction: the caller's [rad/s] */
    int n_values, n_outputs;
    const model_output *outputs; /**< [n_outputs] dims: words of "position", "pair", "harmonic" */
    void *texts;                 /**< of the outputs */
} static_plan;

/** Whether a message is about the points or the torque that were asked for, not about the case. */
bool model_is_of_request(const model_message *message);
/** @return false with the reason in `error`; in any case the plan is to be freed */
bool model_plan_static(const model *model, int mesh, int points, static_plan *plan, model_message *error);
void static_plan_free(static_plan *plan);
/** All values at a torque [N m], [n_values]. @return false with the reason in `error` */
bool model_static(const model *model, const static_plan *plan, double torque, double *values, model_message *error);
/** The largest force of a tooth pair at rest under a torque, where the mesh goes from one position to another [pitches]. [N]
 *  @return NAN where the analysis does not apply */
double model_static_pair_force(const model *model, int mesh, double from, double to, double torque);
