#include "integrate/smallest_step.h"

#include <float.h>

/* Relative to the present time: near a limit of the model's domain the steps would shrink without end unless bounded by
 * rounding. */
static const double smallest_step = 64 * DBL_EPSILON;

double integration_smallest_step(double t)
{
    return smallest_step * t;
}

bool integration_is_later(double later, double t)
{
    return later - t > smallest_step * (t < 0 ? -t : t);
}
