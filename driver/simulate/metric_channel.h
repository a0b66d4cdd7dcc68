/** Statistics of a quantity over a window of whole pitches: moments over time, extremes, harmonics of the mesh order.
 *  Sums are taken over the present period and added to the total when it is complete. */
#pragma once

#include "simulate/step_nodes.h"

enum { METRIC_HARMONICS = 10 };

/* Arrays updated in every step are aligned to cache lines: the structs are allocated in an arena. */

/** Cosine and sine of 2 pi n xi at the nodes, n from 1. */
typedef struct {
    _Alignas(MEMORY_LINE) double wave[2 * METRIC_HARMONICS]
                                     [STEP_NODES_MOST]; /**< all cosines, then all sines; 0 in unused elements */
    double rate[STEP_NODES_MOST];                       /**< of xi [1/s] */
    double near, cosine, sine;                          /**< a position, and the first harmonic there */
} metric_waves;

/** Set the harmonics of position 0: cosine 1, sine 0. */
void metric_waves_init(metric_waves *waves);
/** @param xi, rate  position [pitches] and its rate at the nodes, [nodes] */
void metric_waves_find(metric_waves *waves, int n_nodes, const double *xi, const double *rate);

/** Sums, separately for each node. */
typedef struct {
    _Alignas(MEMORY_LINE) double power[4][STEP_NODES_MOST]; /**< integrals over time of powers of x - shift */
    double wave[2 * METRIC_HARMONICS][STEP_NODES_MOST];     /**< integrals of (x - shift) times the harmonics over xi */
    double high, low;
} channel_sums;

typedef struct {
    bool has_begun;
    double shift;               /**< a value near the mean, against cancellation in the sums of powers */
    channel_sums period, total; /**< present period; all complete periods */
} metric_channel;

/** Moments, extremes and harmonics of a window: input of the formulas in metric_table.h. */
typedef struct {
    double mean, variance, rms;
    double fourth;                                           /**< fourth central moment */
    double high, low;                                        /**< NaN if the quantity is NaN */
    double least;                                            /**< lower bound: smaller values are rounding errors */
    double cosine[METRIC_HARMONICS], sine[METRIC_HARMONICS]; /**< coefficients of the harmonics of the mesh order */
} channel_window;

/** Smallest value of the quantity. */
static inline double channel_window_low(const channel_window *window)
{
    return window->low < window->least ? window->least : window->low;
}

/** Initialise; then call _add for each part of a step, and _complete at the end of each period. */
void metric_channel_init(metric_channel *channel);
/** @param x  at the nodes [nodes->n] */
void metric_channel_add(metric_channel *channel, const step_nodes *nodes, const metric_waves *waves, const double *x);
/** @return the integral over time of x - shift over the period */
double metric_channel_complete(metric_channel *channel);
/** @param time, pitches  length of the complete periods
 *  @param least  lower bound of the quantity */
channel_window metric_channel_conclude(const metric_channel *channel, double time, double pitches, double least);
