/** Integration by the stepper that a model brings along. Private to integrate/. */
#pragma once

#include "integrate/integration.h"

/** To the end. The run's `reason` is empty and its counts are zero. */
integrate_code integrate_by_stepper(integration *run);
