/** A quantity over a window of whole pitches: moments over time, extremes, harmonics of the mesh order. Sums are taken over the present
 *  period and count when it is complete. */
#pragma once

#include "simulate/step_nodes.h"

enum { NUMBER_HARMONICS = 10 };

/* What is added to in every step stands on lines of the cache: it lies in a pool. */

/** Cosine and sine of 2 pi n xi at the nodes, n from 1. */
typedef struct {
    _Alignas(MEMORY_LINE) double wave[2 * NUMBER_HARMONICS]
                                     [STEP_NODES_MOST]; /**< all cosines, then all sines; 0 where no node is */
    double rate[STEP_NODES_MOST];                       /**< of xi [1/s] */
    double near, cosine, sine;                          /**< a place, and the first wave there */
} number_waves;

/** They are 1 at the place 0. */
void number_waves_init(number_waves *waves);
/** @param xi, rate  position [pitches] and its rate at the nodes, [nodes] */
void number_waves_find(number_waves *waves, int n_nodes, const double *xi, const double *rate);

/** Of each node by itself. */
typedef struct {
    _Alignas(MEMORY_LINE) double power[4][STEP_NODES_MOST]; /**< integrals over time of powers of x - shift */
    double wave[2 * NUMBER_HARMONICS][STEP_NODES_MOST];     /**< of (x - shift) times these over xi */
    double high, low;
} channel_sums;

typedef struct {
    bool has_begun;
    double shift;               /**< a value near the mean: sums of powers keep their digits */
    channel_sums period, total; /**< the present period, those that are complete */
} number_channel;

/** Moments, extremes and waves of a window: what the formulas of number_table.h read. */
typedef struct {
    double mean, variance, rms;
    double fourth;                                           /**< central moment */
    double high, low;                                        /**< NaN of a quantity that is NaN */
    double least;                                            /**< of the quantity: values below it are rounding */
    double cosine[NUMBER_HARMONICS], sine[NUMBER_HARMONICS]; /**< of the harmonics of the mesh order */
} channel_window;

/** Smallest value of the quantity. */
static inline double channel_window_low(const channel_window *window)
{
    return window->low < window->least ? window->least : window->low;
}

/** Begin; then one call for each part of a step, and one at the end of each period. */
void number_channel_init(number_channel *channel);
/** @param x  at the nodes [nodes->n] */
void number_channel_add(number_channel *channel, const step_nodes *nodes, const number_waves *waves, const double *x);
/** @return the integral over time of x - shift over the period */
double number_channel_complete(number_channel *channel);
/** @param time, pitches  length of the complete periods
 *  @param least  value of the quantity */
channel_window number_channel_conclude(const number_channel *channel, double time, double pitches, double least);
