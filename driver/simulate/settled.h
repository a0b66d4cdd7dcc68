/** Whether the motion has settled before a window of metrics: by the distance of the start from the steady motion, which decays mode
 *  by mode, and by the means of both halves of the window. docs/numbers.md has the bounds. */
#pragma once

#include "simulate/number_sums.h"

/** Whether the window holds the settled motion. */
typedef struct {
    double is_settled;                   /**< 1 or 0; NaN: it cannot be judged, or was not */
    char reason[2 * DAE_MESSAGE_LENGTH]; /**< why not; "" if it is */
} number_settled;

/** @param starts_periodic  the start is on the periodic orbit: nothing has to decay
 *  @param from, to          the window's whole periods [s] */
void settled_judge(const number_sums *sums, const dae_state *start, bool starts_periodic, double from, double to,
                   number_settled *settled);
