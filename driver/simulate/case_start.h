/** Start of a planned case: every refusal names its location in the file. */
#pragma once

#include "simulate/case_plan.h"

#include <signal.h>

/** Initial state of the case, the last step that can be refused.
 *  @param interrupt  ends the search for a periodic start when it is not 0; NULL: nothing does
 *  @param[out] orbit  of a periodic start; NULL: not requested
 *  @return false with the reason in `error`: EVL_EXIT_CASE; EVL_EXIT_INTEGRATION, EVL_EXIT_INTERRUPTED for a periodic
 *          start */
bool case_start(const case_plan *plan, const volatile sig_atomic_t *interrupt, dae_state *state,
                model_start_orbit *orbit, evl_error *error);
/** Whether the initial state exists, so that `evolvent run` would start. A periodic orbit is not searched for. @return
 *  false with the reason in `error` */
bool case_start_check(const case_plan *plan, evl_error *error);
