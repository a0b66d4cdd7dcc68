#include "integrate/output_grid.h"

#include "integrate/smallest_step.h"

static const double grid_slack = 1e-6; /* relative to the output interval: a grid point this near the end is the end */

integrate_options integrate_options_between(const integrate_options *options, double t, double t_end)
{
    integrate_options between = *options;
    between.t_end = t_end;
    between.output_interval = t_end - t;
    between.per_unit = 0;
    return between;
}

double output_grid_time(const integrate_options *options, double t_start, long index)
{
    const double t = t_start + (double)index * options->output_interval;
    return t > options->t_end - grid_slack * options->output_interval ? options->t_end : t;
}

long output_grid_size(const integrate_options *options, double t_start)
{
    return options->per_unit > 0 ? 0 : (long)((options->t_end - t_start) / options->output_interval - grid_slack) + 2;
}

void output_grid_begin(output_grid *grid, const dae *model, const integrate_options *options, const dae_state *start)
{
    *grid = (output_grid){.options = options, .t_start = start->t, .next = 1};
    if (output_grid_goes_by_position(grid)) {
        position_grid_begin(&grid->positions, model, options, start);
    }
}

bool output_grid_goes_by_position(const output_grid *grid)
{
    return grid->options->per_unit > 0;
}

double output_grid_next(const output_grid *grid)
{
    return output_grid_time(grid->options, grid->t_start, grid->next);
}

bool output_grid_due(output_grid *grid, const integrate_step *step, dae_state *scratch, output_due *due)
{
    *due = (output_due){.has_mark = output_grid_goes_by_position(grid)};
    if (due->has_mark) {
        return position_grid_next(&grid->positions, step, scratch, &due->t, &due->mark);
    }
    due->t = output_grid_next(grid);
    return !integration_is_later(due->t, step->t_to) && due->t < grid->options->t_end;
}

int output_grid_ahead(const output_grid *grid, const integrate_step *step, int most, double t[DAE_LANES])
{
    int n = 0;
    for (; n < most; n++) {
        t[n] = output_grid_time(grid->options, grid->t_start, grid->next + n);
        if (integration_is_later(t[n], step->t_to) || !(t[n] < grid->options->t_end)) {
            break;
        }
    }
    for (int k = n; k < DAE_LANES && n > 0; k++) {
        t[k] = t[n - 1];
    }
    return n;
}

void output_grid_advance(output_grid *grid, const output_due *due)
{
    if (due->has_mark) {
        position_grid_advance(&grid->positions, due->t, &due->mark);
    } else {
        grid->next++;
    }
}

void output_grid_serialize(output_grid *grid, archive *archive)
{
    SERIALIZE(archive, grid->t_start);
    SERIALIZE(archive, grid->next);
    position_grid_serialize(&grid->positions, archive);
}
