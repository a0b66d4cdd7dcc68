/** Results so far and the next step of a response: the values one after the other, up and then down, and the jumps
 *  between them. */
#pragma once

#include "files/response.h"
#include "files/wheel_store.h"
#include "respond/orbit.h"
#include "respond/value_range.h"
#include "simulate/metric_rows.h"

typedef struct {
    memory_arena arena;
    case_base *base;
    const value_range *range;
    int n_set;
    const char *const *set;
    int most;
    const volatile sig_atomic_t *interrupt; /**< as in orbit_find */
    wheel_store *wheels;
    case_plan plan;      /**< of the last value evaluated */
    model_period period; /**< of the same */
    const model_names *names;
    model_output rows[N_METRIC_ROWS];
    int n_values;
    bool goes[RESPONSE_DIRECTIONS];
    /* serialised members */
    int step, n_steps;                           /**< number of values evaluated, of all directions */
    response_point *points[RESPONSE_DIRECTIONS]; /**< [range->n] */
    state_transfer state;                        /**< at the last value */
    int n_jumps;
    response_jump *jumps;
} branch;

/** The direction and value of a step. */
typedef struct {
    int direction, index;
    bool begins; /**< first step of its direction */
} branch_cursor;
branch_cursor branch_at(const branch *branch, int step);

/** Plan the case with a value of the parameter, and find its common period. @return false with the reason in `error` */
bool branch_plan(branch *branch, double value, model_period *period, evl_error *error);
/** Same into another plan. */
bool branch_plan_into(const branch *branch, case_plan *plan, double value, model_period *period, evl_error *error);
/** Find the settled motion at a value. @param state  initial state, or empty: as in the case; becomes the final state
 *  @param point  with space for its metrics */
orbit_end branch_look(branch *branch, double value, state_transfer *state, response_point *point, evl_error *error);
/** Evaluate the value of the next step, and the interval since the previous one if the motion jumped.
 *  @return ORBIT_FAILED with the reason in `error`; then, and after an interrupt, the step remains to be done */
orbit_end branch_step(branch *branch, evl_error *error);
/** Serialise all that a later step needs. */
void branch_serialize(branch *branch, archive *archive);
void branch_free(branch *branch);
