/** Check whether the motion has settled before a window of metrics: by the distance of the start from the steady
 *  motion, which decays mode by mode, and by the means of both halves of the window. docs/reference/numbers.md has the bounds. */
#pragma once

#include "simulate/metric_sums.h"

/** Result of the check. */
typedef struct {
    double is_settled;                   /**< 1 or 0; NaN: not checked, or not decidable */
    char reason[2 * DAE_MESSAGE_LENGTH]; /**< reason if not settled; "" if settled */
} settled_result;

/** @param starts_periodic  the start is on the periodic orbit: there is no transient
 *  @param from, to         the window's whole periods [s] */
void settled_judge(const metric_sums *sums, const dae_state *start, bool starts_periodic, double from, double to,
                   settled_result *settled);
