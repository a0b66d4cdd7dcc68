/** Extremes in the steps of an integrator that tells no more of the channels than what they are at the ends of its steps: three
 *  ends in a row say whether a curve may have turned between the last two. Private to the search for extremes. */
#pragma once

#include "simulate/extreme_channels.h"

/** Channels at the ends of the last two steps. */
typedef struct {
    int n_known;                   /**< ends since nothing was continued; 0: begin anew */
    double t, t_older;             /**< of the last two */
    double *values, *older, *ends; /**< [n] there, and at the end of the present step */
    double *middle;                /**< [n] in its middle */
} channel_past;

void channel_past_init(channel_past *past, const extreme_channels *channels);

/** Keep it. */
void channel_past_keep(channel_past *past, const extreme_channels *channels, archive *archive);

/** Look at a step, from and to times in it. */
void extremes_by_ends(extreme_channels *channels, channel_past *past, const integrate_step *step, double from,
                      double to);
