/** Which reported values are rates of which others: the table of outputs says so. */
#pragma once

#include "base/memory.h"
#include "model/model.h"
#include "simulate/wanted.h"

#include <stdbool.h>

/** One value and its rate, or the sum of all its rates. */
typedef struct {
    int place;                /**< of the value */
    const model_output *rate; /**< NULL if several add up to it */
    bool is_power;            /**< the work of the loads: its rate is the sum of torques times speeds */
} rate_channel;

/** The rates of a run, and what is evaluated for them. */
typedef struct {
    wanted_outputs values;
    int n;
    rate_channel *channels;
    int *channel_of;        /**< [n_values] to which channel a rate belongs; -1: to none */
    int torque, speed;      /**< first values of the wheels */
    model_sampler *sampler; /**< of the values */
    bool in_lanes;          /**< it evaluates eight states at once */
} rate_channels;

rate_channels rate_channels_open(const model *model, memory_pool *pool);
void rate_channels_close(rate_channels *these);
/** Rates of all channels [n] from the values of one of DAE_LANES states that stand side by side. */
void rate_channels_rates(const rate_channels *these, const double *values, int lane, double *rates);
/** The output that a value belongs to, and of what it is: " of wheel 'gear', x", or nothing. */
const model_output *rate_channels_output(const rate_channels *these, int place, char element[96]);
