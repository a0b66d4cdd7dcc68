/** Pairs of reported values and their rates, according to the table of outputs. */
#pragma once

#include "base/memory.h"
#include "model/model.h"
#include "simulate/requested_outputs.h"

#include <stdbool.h>

/** One value and its rate, or the sum of all its rates. */
typedef struct {
    int index;                /**< index of the value */
    const model_output *rate; /**< NULL if it is a sum of several */
    bool is_power;            /**< the work of the loads: its rate is the sum of torques times speeds, without losses */
} rate_channel;

/** The rates of a run, and the outputs evaluated for them. */
typedef struct {
    requested_outputs values;
    int n;
    rate_channel *channels;
    int *channel_of;        /**< [n_values] channel to which a rate belongs; -1: none */
    int torque, speed;      /**< indices of the first values of the wheels */
    int loss;               /**< likewise; -1: no load is a loss */
    model_sampler *sampler; /**< of the values */
    bool in_lanes;          /**< evaluates DAE_LANES states at once */
} rate_channels;

rate_channels rate_channels_open(const model *model, memory_arena *arena);
void rate_channels_close(rate_channels *these);
/** Rates of all channels [n] from the values of one of DAE_LANES interleaved states. */
void rate_channels_rates(const rate_channels *these, const double *values, int lane, double *rates);
/** The output of a value, and its element: " of wheel 'gear', x", or "". */
const model_output *rate_channels_output(const rate_channels *these, int index, char element[96]);
