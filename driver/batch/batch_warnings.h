/** Warnings common to all cases of a batch, printed once. */
#pragma once

#include "batch/batch_plan.h"

/** Print a warning for each key of the base case with a number outside its plausible range. Do the same for each
 *  numeric column of the design. The messages of single cases repeat only the latter. */
void batch_warn(const batch_plan *plan);
