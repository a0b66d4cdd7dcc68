/** Which tolerance an integrator takes for an accuracy that a case states. */
#pragma once

#include "case/description.h"

/** @param accuracy  error of a penetration over the largest one, as it was measured (docs/integrators.md)
 *  @return tolerance, in units of the states' scales */
double accuracy_tolerance(double accuracy, integrator_kind integrator);
