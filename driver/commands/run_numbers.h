/** Summary of the metrics of a case at the end of a run. */
#pragma once

#include "simulate/number_channel.h"
#include "simulate/numbers.h"

/** Print one line per mesh, or the reason why there are no metrics. */
void tell_numbers(const numbers *numbers, const model_names *names);
