#include "integrate/output_grid.h"

static const double grid_slack = 1e-6; /* of an output interval: a grid point this near the end is the end */

double output_grid_time(const integrate_options *options, double t_start, long index)
{
    const double t = t_start + (double)index * options->output_interval;
    return t > options->t_end - grid_slack * options->output_interval ? options->t_end : t;
}

long output_grid_size(const integrate_options *options, double t_start)
{
    return (long)((options->t_end - t_start) / options->output_interval - grid_slack) + 2;
}
