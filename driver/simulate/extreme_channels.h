/** Extremes of channels so far, and the channels at single states of a step. Private to the search for extremes. */
#pragma once

#include "base/memory.h"
#include "integrate/integrate_types.h"

typedef struct {
    const dae *dae;
    memory_arena *arena;          /**< owns all arrays */
    int n;                        /**< number of channels */
    int n_padded;                 /**< the same padded with unused channels for vectorised loops */
    bool has_begun;               /**< at least one state was evaluated */
    double *high, *low;           /**< [n] so far; +INFINITY and -INFINITY if not requested */
    double *high_time, *low_time; /**< [n] */
    double *values;               /**< [n] at the last evaluated state */
    double t_values;              /**< its time, if within the present step; else NAN */
    double *y;                    /**< [states] */
    int n_in_group;               /**< channels of a group; 0: all channels are evaluated at once */
    int *states, *first_state;    /**< [n_groups + 1] states needed by each group, starting at first_state */
    int group;                    /**< group of the last `values`; -1: all */
} extreme_channels;

/** Initialise without requested extremes. @param arena  owns the arrays */
void extreme_channels_init(extreme_channels *channels, const dae *dae, memory_arena *arena);

/** Serialise the results. */
void extreme_channels_serialize(extreme_channels *channels, archive *archive);

/** An array with one number per channel, initially 0. */
double *extreme_channels_array(const extreme_channels *channels);

/** Evaluate the channels at t in the step. @return false if they are not available there */
bool extreme_channels_know(extreme_channels *channels, const integrate_step *step, double t);
/** Same, and update the extremes. */
bool extreme_channels_see(extreme_channels *channels, const integrate_step *step, double t);
/** Same at a given state. @param channel  selects the group to evaluate; -1: all */
bool extreme_channels_see_state(extreme_channels *channels, const dae_state *state, int channel);
/** Update the extremes with one value of a channel. */
void extreme_channels_take(extreme_channels *channels, int channel, double value, double t);

/** Limit that a new extreme of a channel must exceed, in a sense: 1 a maximum, -1 a minimum. */
double extreme_channels_limit(const extreme_channels *channels, int channel, int sense);

/** Bracket of a possible extreme of a channel in a step. */
typedef struct {
    int channel, sense;
    double left, right;
    double start;
    double width;    /**< as in peak_bracket */
    double expected; /**< approximate value at the start, multiplied by the sense; NAN if unknown */
} extreme_bracket;

/** Search for the extreme, and update the extremes with every value evaluated. */
void extreme_channels_climb(extreme_channels *channels, const integrate_step *step, const extreme_bracket *extreme);
