/** Warnings that all cases of a batch share, printed once. */
#pragma once

#include "batch/batch_plan.h"

/** Print a warning for each key of the base case with a number outside its plausible range, and for each column of numbers of the
 *  design with such a value. The messages of single cases repeat the latter only. */
void batch_warn(const batch_plan *plan);
