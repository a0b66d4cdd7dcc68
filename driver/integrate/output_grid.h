/** The times of the outputs: a grid from the start, and the end. */
#pragma once

#include "integrate/integrate_types.h"

/** Of output `index`, 0 at the start; the last one is the end itself. */
double output_grid_time(const integrate_options *options, double t_start, long index);

/** Number of outputs of a whole integration from t_start. */
long output_grid_size(const integrate_options *options, double t_start);
