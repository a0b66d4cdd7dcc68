/** Integration of a dae with SUNDIALS IDA or with the model's own stepper: located events, consistent restarts, output on a grid by
 *  dense output. */
#pragma once

#include "integrate/integrate_types.h"

/** Integrate from `state` to options->t_end. The state is that of the end, or the last good one. `reason` gets one sentence on failure.
 *  With a stepper, y' of the states that the observer is given is that of the last event. Re-entrant. */
integrate_code integrate(const dae *model, const integrate_options *options, const integrate_observer *observer,
                         dae_state *state, integrate_counts *counts, char reason[DAE_MESSAGE_LENGTH]);

/** Version of the integrator's library, such as "SUNDIALS 6.4.1 with KLU". */
const char *integrate_version(void);
