/** Integration with SUNDIALS IDA. Private to integrate/. */
#ifndef EVOLVENT_INTEGRATE_IDA_H
#define EVOLVENT_INTEGRATE_IDA_H

#include "integrate/integration.h"

/** To the end. The run's `reason` is empty and its counts are zero. */
integrate_code integrate_by_ida(integration *run);

/** Version of its library, such as "SUNDIALS 6.4.1". */
const char *integrate_ida_version(void);

#endif
