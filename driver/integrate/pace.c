#include "integrate/pace.h"

#include <float.h>
#include <math.h>
#include <string.h>

enum { MOST_EVENTS = 1000, MOST_STEPS = 100000 };

static const double rounding = 64 * DBL_EPSILON; /* of the present time */
static const double part_of_run = 1e-10;
static const double stretch = 1e-6; /* part of the run on which the number of steps is limited */
static const double crept_at_least = 1e6, crept_share = 1e-3;

pace pace_create(void)
{
    return (pace){.t_began = -DBL_MAX, .t_crept = -DBL_MAX};
}

double pace_grain(double t, double t_end)
{
    return fmax(rounding * fabs(t), part_of_run * t_end);
}

static void go_on(pace *pace, double t, double grain)
{
    if (t > pace->t_began + grain) {
        pace->t_began = t;
        pace->events = pace->steps = 0;
    }
}

bool pace_event(pace *pace, double t, double grain)
{
    go_on(pace, t, grain);
    return ++pace->events <= MOST_EVENTS;
}

bool pace_steps(pace *pace, int n, double t, double grain)
{
    go_on(pace, t, grain);
    pace->steps += n;
    return pace->steps <= MOST_STEPS;
}

pace_budget pace_spend(pace *pace, int n, double t, double t_end, double most)
{
    if (t > pace->t_crept + stretch * t_end) {
        pace->t_crept = t;
        pace->crept = 0;
    }
    pace->all += n;
    pace->crept += n;
    return pace->all >= most                                         ? PACE_SPENT
           : pace->crept >= fmax(crept_at_least, crept_share * most) ? PACE_CREEPS
                                                                     : PACE_FITS;
}

void pace_note(pace *pace, double t, const dae_event *what)
{
    if (pace->n_recent > 0 && (what->kind != pace->last.kind || what->subject != pace->last.subject)) {
        pace->n_recent = 0;
    }
    pace->last = *what;
    if (pace->n_recent == PACE_RECENT) {
        memmove(pace->t_recent, pace->t_recent + 1, (PACE_RECENT - 1) * sizeof *pace->t_recent);
        pace->n_recent--;
    }
    pace->t_recent[pace->n_recent++] = t;
}

bool pace_gathers(const pace *pace, double *within)
{
    const double *t = pace->t_recent;
    *within = t[PACE_RECENT - 1] - t[0];
    const bool quickens = 2 * t[PACE_RECENT / 2] > t[0] + t[PACE_RECENT - 1];
    return pace->n_recent == PACE_RECENT && quickens;
}

void pace_keep(pace *pace, archive *archive)
{
    KEEP(archive, pace->t_began);
    KEEP(archive, pace->events);
    KEEP(archive, pace->steps);
    KEEP(archive, pace->all);
    KEEP(archive, pace->t_crept);
    KEEP(archive, pace->crept);
    KEEP_ARRAY(archive, pace->t_recent, PACE_RECENT);
    KEEP(archive, pace->n_recent);
    KEEP(archive, pace->last);
}
