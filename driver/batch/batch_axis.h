/** Common axis of the stacked histories of all cases: every n-th output of a grid of times or of positions. */
#pragma once

#include "files/design.h"
#include "files/history.h"
#include "simulate/case_plan.h"

typedef struct {
    long every;             /**< one of this number of outputs is stored */
    integrate_options grid; /**< of the outputs */
    positions_rule rule;    /**< of the first case, which owns the texts */
    history_coordinate coordinate;
    double *values; /**< of the coordinate, owned */
} batch_axis;

/** Create the axis for a case. @return false with the reason in `error` */
bool batch_axis_make(batch_axis *axis, const design *design, const case_plan *first, evl_error *error);
void batch_axis_free(batch_axis *axis);
/** Whether the outputs of a case match the axis. */
bool batch_axis_fits(const batch_axis *axis, const case_plan *of_case);
/** Index of an output on the axis; -1 if it is not on it.
 *  @param index  of the output in its run, from 0
 *  @param mark   of an output by position */
long batch_axis_index(const batch_axis *axis, long index, double t, const output_mark *mark);

/** The time, stored with every history over positions. Its offset among the outputs is -1. */
extern const model_output batch_axis_time;
