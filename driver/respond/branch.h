/** What was found so far, and how it goes on: the values one after the other, up and then down, and the jumps between them. */
#pragma once

#include "files/response.h"
#include "files/wheel_store.h"
#include "respond/orbit.h"
#include "respond/value_range.h"
#include "simulate/number_rows.h"

typedef struct {
    memory_pool pool;
    case_base *base;
    const value_range *range;
    int n_set;
    const char *const *set;
    int most;
    const volatile sig_atomic_t *interrupt; /**< as of orbit_find */
    wheel_store *wheels;
    prepared_case prepared; /**< of the value that was looked at last */
    model_period period;    /**< of that */
    const model_names *names;
    model_output rows[N_NUMBER_ROWS];
    int n_values;
    bool goes[RESPONSE_DIRECTIONS];
    /* what is kept */
    int step, n_steps;                           /**< values that were looked at, of all directions */
    response_point *points[RESPONSE_DIRECTIONS]; /**< [range->n] */
    carried state;                               /**< of the last value */
    int n_jumps;
    response_jump *jumps;
} branch;

/** The direction and value of a step. */
typedef struct {
    int direction, index;
    bool begins; /**< the first one of its direction */
} branch_place;
branch_place branch_at(const branch *branch, int step);

/** Prepare the case with a value of the parameter, and find its common period. @return false with the reason in `error` */
bool branch_prepare(branch *branch, double value, model_period *period, evl_error *error);
/** The same in another place. */
bool branch_prepare_as(const branch *branch, prepared_case *prepared, double value, model_period *period,
                       evl_error *error);
/** The motion that is come to at a value. @param state  where it begins, or nothing: then as the case says; becomes that of its end
 *  @param point  with room for its numbers */
orbit_end branch_look(branch *branch, double value, carried *state, response_point *point, evl_error *error);
/** Look at the value of the next step, and at what lies between it and the one before if the motion jumped.
 *  @return ORBIT_FAILED with the reason in `error`; then, and when it was interrupted, the step is still to be done */
orbit_end branch_step(branch *branch, evl_error *error);
/** Keep all that a later step needs. */
void branch_keep(branch *branch, archive *archive);
void branch_free(branch *branch);
