/** What a model is given and asked by who moves it from outside. */
#pragma once

#include "model/model.h"

/** A constant torque or a prescribed speed of the case, which can be given anew while the gearbox moves. */
typedef struct {
    int load;      /**< for model_feed */
    int wheel;     /**< on which it acts */
    bool is_speed; /**< a speed [rad/s], else a torque [N m] */
    double value;  /**< now */
    char *path;    /**< of the parameter that the case gives for it: wheels.pinion.loads.0.value */
} model_input;

/** The inputs, wheel after wheel, a new array in the pool. @return how many */
int model_inputs(const model *model, memory_pool *pool, model_input **inputs);
/** Give an input anew: the model's owner alone does so, and who integrates goes on by a restart.
 *  @param value  the torque, or the speed, which counts at a start only
 *  @param rate   of a speed [rad/s^2]; 0 for a torque */
void model_feed(const model *model, int load, double value, double rate);
/** Angular velocity of a wheel [rad/s], seen from where a prescribed speed of it refers to. */
double model_wheel_speed(const model *model, int wheel, const dae_state *state);
/** Fill yp of a state: y' = f(t, y). @return a dae_code */
int model_rates(const model *model, dae_state *state, char message[DAE_MESSAGE_LENGTH]);
