/** One motion of a case, moved from outside: by steps, with the integrator radau inside, or as states, rates and events for an
 *  integrator of the caller's. Its inputs may change on the way. It prints nothing and writes no file; a motion belongs to one thread
 *  at a time. */
#pragma once

#include "base/archive.h"
#include "base/status.h"
#include "case/description.h"
#include "model/model_inputs.h"
#include "simulate/prepare.h"

typedef struct motion motion;

/** An input and what it is at present. */
typedef struct {
    model_input of;
    double value; /**< [N m] or [rad/s] */
    double rate;  /**< of a speed [rad/s^2] */
    bool is_new;  /**< given, and not yet used */
    double used;  /**< rate as which the wheel of a speed turns on at present */
} motion_input;

/** A parameter of the case, with what it is at present. */
typedef struct {
    evl_parameter of;
    const char *text; /**< what it means */
    double *numbers;  /**< [of.n] in its unit */
    bool is_given;    /**< anew, for the next start */
} motion_parameter;

/** What is fixed of a motion. */
typedef struct {
    const prepared_case *prepared;
    int n_states, n_indicators, n_values; /**< n_values: of the outputs that the case chooses */
    int n_outputs, n_inputs, n_parameters;
    const int *outputs;           /**< [n_outputs] which of the model's, in the order of the values */
    motion_input *inputs;         /**< [n_inputs] */
    motion_parameter *parameters; /**< [n_parameters] */
} motion_facts;

/** The motion of a prepared case, which becomes its own even if it is refused. @return NULL with the reason in `error`: radau does
 *  not serve it */
motion *motion_create(prepared_case *prepared, evl_error *error);
/** The same of a text that case_text gave. @param name  what errors call it */
motion *motion_read(const char *name, const char *text, evl_error *error);
void motion_delete(motion **motion);
const motion_facts *motion_about(const motion *motion);
/** Why the last call failed. */
const evl_error *motion_error(const motion *motion);

/** Give numbers [n] of a parameter for the next start. */
void motion_set_parameter(motion *motion, int index, const double *numbers);
/** Give an input; the number or its rate. */
void motion_set_input(motion *motion, int index, bool is_rate, double value);

/** Begin at t = 0 with the parameters and inputs as they are.
 *  @param by_steps  radau makes the steps
 *  @param t_end     no step goes beyond; DBL_MAX: the caller does not know */
bool motion_start(motion *motion, bool by_steps, double t_end);
/** Forget parameters, inputs and where it is: as after motion_create. */
bool motion_reset(motion *motion);

/** Move on by steps to time t, not before the present one. @return false: it failed, and is where it was, or on the way */
bool motion_to(motion *motion, double t);

/** The present state; a caller that integrates changes t and y by motion_place. */
const dae_state *motion_state(const motion *motion);
/** Units in which the states count [n_states]. */
const double *motion_scales(const motion *motion);
/** Go to another time, or state [n_states] if that is not NULL, without a change of the discrete state. */
void motion_place(motion *motion, double t, const double *y);
/** y' [n_states] at the present state; NULL if it fails: DAE_RECOVERABLE in *code for a trial state outside the model's domain. */
const double *motion_rates(motion *motion, dae_code *code);
/** Event indicators [n_indicators]: an event is where one changes its sign. After an event none is zero, and one without a meaning is 1.
 *  NULL as above. */
const double *motion_indicators(motion *motion, dae_code *code);
/** Values of the outputs [n_values], NaN without a meaning; NULL as above. */
const double *motion_outputs(motion *motion, dae_code *code);

/** What an update has changed, and when the next one is due. */
typedef struct {
    bool again;          /**< one more is to follow at once */
    bool states_changed; /**< y, not only the discrete state */
    double next;         /**< [s] of the next event in time; infinite if there is none */
} motion_change;

/** Whether an event is due at the present state: the caller has not told of it, or comes in time. NaN-safe: a failure is one. */
bool motion_is_due(motion *motion);
/** Apply what happens at the present state. */
bool motion_update(motion *motion, motion_change *change);
/** Whether the wheels with given speeds turn as these say, within a thousandth. @return false with the reason: a speed has jumped */
bool motion_check_speeds(motion *motion);

/** Keep all that changes, or read it: the same case goes on from there with the same bits. @return false with the reason */
bool motion_keep(motion *motion, archive *archive);
