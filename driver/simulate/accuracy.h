/** Tolerance of an integrator for the accuracy specified in a case. */
#pragma once

#include "case/description.h"

/** @param accuracy  error of a penetration relative to the largest one, as measured (docs/guides/integrators.md)
 *  @return tolerance, in units of the states' scales */
double accuracy_tolerance(double accuracy, integrator_kind integrator);
