#include "respond/respond_summary.h"

#include "base/log.h"

#include <math.h>

void respond_warn_of_settling(const branch *b)
{
    static const double constants = 25;
    const response_point *slowest = NULL;
    double most = 0, value = 0;
    for (int step = 0; step < b->step; step++) {
        const branch_cursor at = branch_at(b, step);
        const response_point *point = &b->points[at.direction][at.index];
        const double periods = isnan(point->time_constant) ? 0 : point->time_constant / point->common_time;
        if (point->period == RESPONSE_SETTLING && (slowest == NULL || periods > most)) {
            slowest = point;
            most = periods;
            value = value_range_at(b->range, at.index);
        }
    }
    if (slowest == NULL) {
        return;
    }
    CLEANUP_FREE char *option = value_range_option(b->range, value);
    if (most > 0) {
        log_warning(
            "%s: the motion is still settling after %d common periods: the slowest mode has a time constant of %.4g s, "
            "%.4g common periods; increase --periods to %.0f",
            option, slowest->periods, slowest->time_constant, most,
            fmin(RESPOND_MOST, ceil(fmax(constants * most, 4.0 * slowest->periods))));
    } else {
        log_warning("%s: the motion is still settling after %d common periods; increase --periods to %d", option,
                    slowest->periods, 4 * slowest->periods);
    }
}

void respond_summarise(const branch *b, const char *path)
{
    static const char *const words[] = {"up", "down"};
    for (int i = 0; i < b->n_jumps; i++) {
        const response_jump *jump = &b->jumps[i];
        log_note(
            "%s: jump between %.9g and %.9g%s%s; transmission error, standard deviation %.4g um before, %.4g um after",
            words[jump->direction], jump->before, jump->after, b->range->unit[0] == '\0' ? "" : " ", b->range->unit,
            1e6 * jump->deviation_before[0], 1e6 * jump->deviation_after[0]);
    }
    int n_other = 0, n_wild = 0, n_settling = 0;
    for (int step = 0; step < b->step; step++) {
        const branch_cursor at = branch_at(b, step);
        n_other += b->points[at.direction][at.index].period > 1;
        n_wild += b->points[at.direction][at.index].period == 0;
        n_settling += b->points[at.direction][at.index].period == RESPONSE_SETTLING;
    }
    log_note("%d values, %d with a period of 2 and more, %d not periodic, %d still settling, %d jump%s: %s", b->step,
             n_other, n_wild, n_settling, b->n_jumps, b->n_jumps == 1 ? "" : "s", path);
}
