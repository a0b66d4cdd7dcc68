/** Stable orbit near a slowly settling motion, by shooting; the motion can continue from it. docs/guides/response.md. */
#pragma once

#include "respond/state_transfer.h"

#include "integrate/integrate.h"
#include "simulate/case_plan.h"

#include <signal.h>

/** Quasi-static motion at the section: integrated to it from the steady state at t = 0.
 *  @param phase  of the section
 *  @return false if there is no steady state, or the integration fails */
bool shortcut_quasi_static(const case_plan *plan, const model_period *period, double phase,
                           const volatile sig_atomic_t *interrupt, state_transfer *to);
/** Find the orbit.
 *  @param near       a state of the motion on the section
 *  @param periods    common periods of the orbit
 *  @param time       of a common period [s]
 *  @param options    of the integration
 *  @param to         becomes the state of the orbit on the section
 *  @return whether there is one, and it is stable */
bool shortcut_find(const section *section, const state_transfer *near, int periods, double time,
                   const integrate_options *options, const volatile sig_atomic_t *interrupt, state_transfer *to);
