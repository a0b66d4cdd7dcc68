/** Smallest step of an integration that exceeds rounding. */
#pragma once

#include <stdbool.h>

/** Whether `later` is later than t by more than rounding, so that a step is possible. */
bool integration_is_later(double later, double t);
/** Smallest step at the present time. */
double integration_smallest_step(double t);
