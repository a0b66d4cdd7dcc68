/** Extremes in the steps of an integrator that provides the channels only at the ends of its steps. Three consecutive
 *  ends show whether a curve may have an extreme between the last two. Private to the search for extremes. */
#pragma once

#include "simulate/extreme_channels.h"

/** Channels at the ends of the last two steps. */
typedef struct {
    int n_known;                   /**< consecutive ends known; 0: restart */
    double t, t_older;             /**< of the last two ends */
    double *values, *older, *ends; /**< [n] at the last end, the one before, and the end of the present step */
    double *middle;                /**< [n] in the middle of the present step */
} channel_past;

void channel_past_init(channel_past *past, const extreme_channels *channels);

/** Serialise the state. */
void channel_past_serialize(channel_past *past, const extreme_channels *channels, archive *archive);

/** Search the part of a step between two times. */
void extremes_by_ends(extreme_channels *channels, channel_past *past, const integrate_step *step, double from,
                      double to);
