/** The axis along which the histories of all cases are stacked: every so many outputs of a grid of times or of positions. */
#pragma once

#include "files/design.h"
#include "files/history.h"
#include "simulate/positions.h"
#include "simulate/simulate.h"

typedef struct {
    long every;             /**< of the outputs one is kept */
    integrate_options grid; /**< of the outputs */
    positions_rule rule;    /**< of the first case, whose texts it holds */
    history_coordinate coordinate;
    double *values; /**< of the coordinate, owned */
} batch_axis;

/** Make the axis that suits a case. @return false with the reason in `error` */
bool batch_axis_make(batch_axis *axis, const design *design, const prepared_case *first, evl_error *error);
void batch_axis_free(batch_axis *axis);
/** Whether the outputs of a case have places on it. */
bool batch_axis_fits(const batch_axis *axis, const prepared_case *prepared);
/** Where an output goes; -1 if it has no place.
 *  @param index  of the output in its run, from 0
 *  @param mark   of an output by position */
long batch_axis_place(const batch_axis *axis, long index, double t, const output_mark *mark);

/** What comes with every history along positions: the time. Its offset among the outputs is -1. */
extern const model_output batch_axis_time;
