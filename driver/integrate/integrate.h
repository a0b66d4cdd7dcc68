/** Integration of a dae with SUNDIALS IDA or with the model's own stepper: event location, consistent restarts, dense
 *  output on a grid. */
#pragma once

#include "integrate/integrate_types.h"

/** Integrate from `state`, which becomes the final state, or the last valid one. `reason` gets one sentence on failure.
 *  With a stepper, y' in the states passed to the observer is that of the last event. Re-entrant. */
integrate_code integrate(const dae *model, const integrate_options *options, const integrate_observer *observer,
                         dae_state *state, integrate_counts *counts, char reason[DAE_MESSAGE_LENGTH]);

/** Version of the integrator's library, such as "SUNDIALS 6.4.1 with KLU". */
const char *integrate_version(void);
