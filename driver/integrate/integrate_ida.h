/** Integration with SUNDIALS IDA. Private to integrate/. */
#pragma once

#include "integrate/integration.h"

/** To the end. The run's `reason` is empty and its counts are zero. */
integrate_code integrate_by_ida(integration *run);

/** Version of its library, such as "SUNDIALS 6.4.1". */
const char *integrate_ida_version(void);
