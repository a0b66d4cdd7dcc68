#include "batch/batch_axis.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

const model_output batch_axis_time = {.name = "time",
                                      .units = "s",
                                      .symbol = "t",
                                      .long_name = "model time at which the position was first reached",
                                      .dims = "",
                                      .offset = -1,
                                      .count = 1};

static const double same = 1e-6; /* relative to the output interval: smaller differences of times are rounding */

static void take_times(batch_axis *axis)
{
    const long last = output_grid_size(&axis->grid, 0) - 1;
    axis->coordinate = (history_coordinate){.name = "time", .units = "s", .symbol = "t", .long_name = "model time"};
    axis->coordinate.n = (int)(last / axis->every) + 1;
    axis->values = xcalloc((size_t)axis->coordinate.n, sizeof *axis->values);
    for (int i = 0; i < axis->coordinate.n; i++) {
        const long k = i * axis->every;
        axis->values[i] = k == last ? axis->grid.t_end : (double)k * axis->grid.output_interval;
    }
}

static void take_positions(batch_axis *axis, long n)
{
    axis->coordinate = (history_coordinate){.name = "output_position",
                                            .units = "1",
                                            .symbol = axis->rule.what[0] == 'm' ? "xi" : "phi/(2 pi)",
                                            .long_name = axis->rule.what[0] == 'm' ? "pitches of a driving wheel"
                                                                                   : "revolutions of a wheel",
                                            .n = (int)n};
    axis->values = xcalloc((size_t)n, sizeof *axis->values);
    for (long i = 0; i < n; i++) {
        axis->values[i] = (double)(i * axis->every) / axis->rule.number;
    }
}

bool batch_axis_make(batch_axis *axis, const design *design, const case_plan *first, evl_error *error)
{
    *axis = (batch_axis){.every = design->history_every, .grid = first->integration, .rule = first->positions};
    const bool by_position = axis->rule.per != NULL;
    if (by_position != (design->history_rows > 0)) {
        return by_position
                   ? evl_error_set(error, EVL_EXIT_CASE, design->file,
                                   "history_rows: is missing, but outputs of these cases are by position, so their "
                                   "number is unknown; give the number of stored rows (in a plan histories.rows)")
                   : evl_error_set(error, EVL_EXIT_CASE, design->file,
                                   "history_rows: is %ld, but outputs of these cases are by time, which gives their "
                                   "number; omit it (in a plan histories.rows)",
                                   design->history_rows);
    }
    if (by_position) {
        take_positions(axis, design->history_rows);
    } else {
        take_times(axis);
    }
    axis->coordinate.values = axis->values;
    return true;
}

void batch_axis_free(batch_axis *axis)
{
    free(axis->values);
    *axis = (batch_axis){0};
}

bool batch_axis_fits(const batch_axis *axis, const case_plan *of_case)
{
    const integrate_options *grid = &of_case->integration;
    const positions_rule *rule = &of_case->positions;
    if (axis->rule.per != NULL && rule->per != NULL) {
        return rule->number == axis->rule.number && strcmp(rule->what, axis->rule.what) == 0 &&
               strcmp(rule->of, axis->rule.of) == 0;
    }
    return axis->rule.per == NULL && rule->per == NULL && grid->t_end == axis->grid.t_end &&
           grid->output_interval == axis->grid.output_interval;
}

long batch_axis_index(const batch_axis *axis, long index, double t, const output_mark *mark)
{
    long k = index / axis->every;
    bool good = index % axis->every == 0;
    if (axis->rule.per != NULL) {
        const double line = round(mark->position * axis->rule.number);
        good = mark->kind == OUTPUT_FORWARDS && line >= 0 && fmod(line, (double)axis->every) < 0.5 &&
               line / (double)axis->every < axis->coordinate.n;
        k = good ? lround(line) / axis->every : -1;
    } else {
        good = good && k < axis->coordinate.n &&
               fabs(t - axis->values[k]) <= same * axis->grid.output_interval; /* excludes the last state of a run that
                                                                                * fails */
    }
    return good ? k : -1;
}
