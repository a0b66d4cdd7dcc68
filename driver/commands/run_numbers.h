/** The numbers of a case in words, at the end of a run. */
#pragma once

#include "simulate/number_channel.h"
#include "simulate/numbers.h"

/** A line a mesh, or why there are no numbers. */
void tell_numbers(const numbers *numbers, const model_names *names);
