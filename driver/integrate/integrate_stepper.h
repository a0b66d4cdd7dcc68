/** Integration by the stepper that a model brings along. Private to integrate/. */
#ifndef EVOLVENT_INTEGRATE_STEPPER_H
#define EVOLVENT_INTEGRATE_STEPPER_H

#include "integrate/integration.h"

/** To the end. The run's `reason` is empty and its counts are zero. */
integrate_code integrate_by_stepper(integration *run);

#endif
