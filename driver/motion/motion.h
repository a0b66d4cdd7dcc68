/** One motion of a case, driven from outside: by steps of the integrator radau, or as states, rates and events for the
 *  caller's integrator. Its inputs may change during the motion. It prints nothing and writes no file; only one thread
 *  at a time may use a motion. */
#pragma once

#include "motion/motion_types.h"

/** The motion of a planned case, of which it takes ownership even on refusal. @return NULL with the reason in `error`:
 *  radau does not support it */
motion *motion_create(case_plan *plan, evl_error *error);
/** Same for a text from case_text. @param name  name in error messages */
motion *motion_read(const char *name, const char *text, evl_error *error);
void motion_delete(motion **motion);
const motion_facts *motion_about(const motion *motion);
/** Reason of the last failure. */
const evl_error *motion_error(const motion *motion);

/** Set the numbers [n] of a parameter for the next start. */
void motion_set_parameter(motion *motion, int index, const double *numbers);
/** Set an input: the value or its rate. */
void motion_set_input(motion *motion, int index, bool is_rate, double value);

/** Start at t = 0 with the present parameters and inputs.
 *  @param by_steps  radau makes the steps
 *  @param t_end     no step passes it; DBL_MAX: unknown */
bool motion_start(motion *motion, bool by_steps, double t_end);
/** Reset parameters, inputs and state, as after motion_create. */
bool motion_reset(motion *motion);

/** Advance by steps to time t, not before the present one. @return false: it failed, at its earlier state or on the way */
bool motion_to(motion *motion, double t);

/** The present state; a caller with its own integrator changes t and y by motion_set_state. */
const dae_state *motion_state(const motion *motion);
/** Scales of the states [n_states]. */
const double *motion_scales(const motion *motion);
/** Set the time, and the state [n_states] if that is not NULL, without a change of the discrete state. */
void motion_set_state(motion *motion, double t, const double *y);
/** y' [n_states] at the present state; NULL if it fails: DAE_RECOVERABLE in *code for a trial state outside the model's domain. */
const double *motion_rates(motion *motion, dae_code *code);
/** Event indicators [n_indicators]: a change of sign is an event. After an event none is zero, and inapplicable ones
 *  are 1. NULL as above. */
const double *motion_indicators(motion *motion, dae_code *code);
/** Values of the outputs [plan->n_values], NaN if undefined; NULL as above. */
const double *motion_outputs(motion *motion, dae_code *code);

/** Effect of an update, and the time of the next event. */
typedef struct {
    bool again;          /**< another update must follow at once */
    bool states_changed; /**< y, not only the discrete state */
    double next;         /**< [s] of the next time event; infinite if there is none */
} motion_change;

/** Whether an event is due at the present state: one that the caller has not reported, or a time event. NaN-safe: a
 *  failure counts as one. */
bool motion_is_due(motion *motion);
/** Apply the events at the present state. */
bool motion_update(motion *motion, motion_change *change);
/** Whether the wheels with prescribed speeds have these speeds, within a thousandth. @return false with the reason: a
 *  speed has jumped */
bool motion_check_speeds(motion *motion);

/** Serialise all that changes, or read it: the same case continues with bitwise the same results. @return false with
 *  the reason */
bool motion_serialize(motion *motion, archive *archive);
