/** Inputs and outputs of a model that is driven from outside. */
#pragma once

#include "model/model.h"

/** A constant torque or a prescribed speed of the case, which can be changed during the motion. */
typedef struct {
    int load;      /**< argument of model_feed */
    int wheel;     /**< on which it acts */
    bool is_speed; /**< a speed [rad/s], else a torque [N m] */
    double value;  /**< present value */
    char *path;    /**< of its parameter in the case: wheels.pinion.loads.0.value */
} model_input;

/** The inputs in the order of the wheels, a new array in the arena. @return their number */
int model_inputs(const model *model, memory_arena *arena, model_input **inputs);
/** Change an input: only by the model's owner; an integrator must restart afterwards.
 *  @param value  the torque, or the speed, which is used only at a start
 *  @param rate   of a speed [rad/s^2]; 0 for a torque */
void model_feed(const model *model, int load, double value, double rate);
/** Angular velocity of a wheel [rad/s], relative to the reference of a prescribed speed. */
double model_wheel_speed(const model *model, int wheel, const dae_state *state);
/** Fill yp of a state: y' = f(t, y). @return a dae_code */
int model_rates(const model *model, dae_state *state, char message[DAE_MESSAGE_LENGTH]);
