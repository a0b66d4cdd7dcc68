#include "integrate/progress_rate.h"

#include <float.h>
#include <math.h>
#include <string.h>

enum { MOST_EVENTS = 1000, MOST_STEPS = 100000 };

static const double rounding = 64 * DBL_EPSILON; /* of the present time */
static const double part_of_run = 1e-10;
static const double stretch = 1e-6; /* part of the run on which the number of steps is limited */
static const double crept_at_least = 1e6, crept_share = 1e-3;

progress_rate progress_rate_create(void)
{
    return (progress_rate){.t_began = -DBL_MAX, .t_crept = -DBL_MAX};
}

double progress_rate_resolution(double t, double t_end)
{
    return fmax(rounding * fabs(t), part_of_run * t_end);
}

static void go_on(progress_rate *progress_rate, double t, double grain)
{
    if (t > progress_rate->t_began + grain) {
        progress_rate->t_began = t;
        progress_rate->events = progress_rate->steps = 0;
    }
}

bool progress_rate_event(progress_rate *progress_rate, double t, double grain)
{
    go_on(progress_rate, t, grain);
    return ++progress_rate->events <= MOST_EVENTS;
}

bool progress_rate_steps(progress_rate *progress_rate, int n, double t, double grain)
{
    go_on(progress_rate, t, grain);
    progress_rate->steps += n;
    return progress_rate->steps <= MOST_STEPS;
}

step_budget progress_rate_spend(progress_rate *progress_rate, int n, double t, double t_end, double most)
{
    if (t > progress_rate->t_crept + stretch * t_end) {
        progress_rate->t_crept = t;
        progress_rate->crept = 0;
    }
    progress_rate->all += n;
    progress_rate->crept += n;
    return progress_rate->all >= most                                         ? BUDGET_SPENT
           : progress_rate->crept >= fmax(crept_at_least, crept_share * most) ? BUDGET_TOO_SLOW
                                                                              : BUDGET_FITS;
}

void progress_rate_note(progress_rate *progress_rate, double t, const dae_event *what)
{
    if (progress_rate->n_recent > 0 &&
        (what->kind != progress_rate->last.kind || what->subject != progress_rate->last.subject)) {
        progress_rate->n_recent = 0;
    }
    progress_rate->last = *what;
    if (progress_rate->n_recent == PROGRESS_RATE_RECENT) {
        memmove(progress_rate->t_recent, progress_rate->t_recent + 1,
                (PROGRESS_RATE_RECENT - 1) * sizeof *progress_rate->t_recent);
        progress_rate->n_recent--;
    }
    progress_rate->t_recent[progress_rate->n_recent++] = t;
}

bool progress_rate_accumulates(const progress_rate *progress_rate, double *within)
{
    const double *t = progress_rate->t_recent;
    *within = t[PROGRESS_RATE_RECENT - 1] - t[0];
    const bool quickens = 2 * t[PROGRESS_RATE_RECENT / 2] > t[0] + t[PROGRESS_RATE_RECENT - 1];
    return progress_rate->n_recent == PROGRESS_RATE_RECENT && quickens;
}

void progress_rate_serialize(progress_rate *progress_rate, archive *archive)
{
    SERIALIZE(archive, progress_rate->t_began);
    SERIALIZE(archive, progress_rate->events);
    SERIALIZE(archive, progress_rate->steps);
    SERIALIZE(archive, progress_rate->all);
    SERIALIZE(archive, progress_rate->t_crept);
    SERIALIZE(archive, progress_rate->crept);
    SERIALIZE_ARRAY(archive, progress_rate->t_recent, PROGRESS_RATE_RECENT);
    SERIALIZE(archive, progress_rate->n_recent);
    SERIALIZE(archive, progress_rate->last);
}
