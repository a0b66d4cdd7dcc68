/** The extremes of channels so far, and the channels at single states of a step. Private to the search for extremes. */
#pragma once

#include "base/memory.h"
#include "integrate/integrate_types.h"

typedef struct {
    const dae *dae;
    memory_pool *pool;            /**< of all arrays */
    int n;                        /**< channels */
    int n_padded;                 /**< the same with idle ones behind them, so that loops over all go in vectors */
    bool has_begun;               /**< a state was seen */
    double *high, *low;           /**< [n] so far; +INFINITY and -INFINITY if nobody asks */
    double *high_time, *low_time; /**< [n] */
    double *values;               /**< [n] at the state last asked */
    double t_values;              /**< its time, if it is in the present step; else NAN */
    double *y;                    /**< [states] */
    int n_in_group;               /**< channels of a group; 0: all channels are asked for at once */
    int *states, *first_state;    /**< [n_groups + 1] of each group the states that it needs begin at first_state */
    int group;                    /**< that `values` were last found of; -1: of all */
} extreme_channels;

/** Nobody asks for anything yet. @param pool  in which the channels last */
void extreme_channels_init(extreme_channels *channels, const dae *dae, memory_pool *pool);

/** Keep what was found. */
void extreme_channels_keep(extreme_channels *channels, archive *archive);

/** Room for a number of each channel, 0 at first. */
double *extreme_channels_array(const extreme_channels *channels);

/** Find the channels at t, which lies in the step. @return false if they are not known there */
bool extreme_channels_know(extreme_channels *channels, const integrate_step *step, double t);
/** The same, and take note of them. */
bool extreme_channels_see(extreme_channels *channels, const integrate_step *step, double t);
/** The same at a state. @param channel  which those belong together with that are asked for; -1: all */
bool extreme_channels_see_state(extreme_channels *channels, const dae_state *state, int channel);
/** One value of a channel. */
void extreme_channels_take(extreme_channels *channels, int channel, double value, double t);

/** What a channel has to exceed, in a sense: 1 a maximum, -1 a minimum. */
double extreme_channels_limit(const extreme_channels *channels, int channel, int sense);

/** Where an extreme of a channel may lie in a step. */
typedef struct {
    int channel, sense;
    double left, right;
    double start;
    double width;    /**< as of peak_bracket */
    double expected; /**< about what the channel is at the start, in the sense; NAN if that is not known */
} extreme_place;

/** Go there and take note of what is seen on the way. */
void extreme_channels_climb(extreme_channels *channels, const integrate_step *step, const extreme_place *place);
