/** Constant data of a motion, its inputs and its parameters. */
#pragma once

#include "model/model_inputs.h"
#include "simulate/case_plan.h"

typedef struct motion motion;

/** An input and its present value. */
typedef struct {
    model_input of;
    double value; /**< [N m] or [rad/s] */
    double rate;  /**< of a speed [rad/s^2] */
    bool is_new;  /**< set, and not yet applied */
    double used;  /**< present rate of the wheel of a prescribed speed */
} motion_input;

/** A parameter of the case and its present value. */
typedef struct {
    evl_parameter of;
    const char *text; /**< description */
    double *numbers;  /**< [of.n] in its unit */
    bool is_set;      /**< changed for the next start */
} motion_parameter;

/** Constant data of a motion. */
typedef struct {
    const case_plan *plan;
    int n_states, n_indicators, n_inputs, n_parameters;
    motion_input *inputs;         /**< [n_inputs] */
    motion_parameter *parameters; /**< [n_parameters] */
} motion_facts;
