/** Progress monitor of a run: events and steps without progress, and accumulating events. */
#pragma once

#include "base/archive.h"
#include "integrate/dae.h"

enum { PACE_RECENT = 9 };

typedef struct {
    double t_began;               /**< time since which there was no progress */
    int events, steps;            /**< since then */
    double all;                   /**< steps of the run so far */
    double t_crept, crept;        /**< start of the present stretch of the run, and the steps on it */
    double t_recent[PACE_RECENT]; /**< of the last events of the same kind, the latest last */
    int n_recent;
    dae_event last;
} pace;

/** State of a run's step budget: sufficient; exhausted; or too slow. */
typedef enum { PACE_FITS, PACE_SPENT, PACE_CREEPS } pace_budget;

/** Initial state. */
pace pace_create(void);
/** Smallest time increment that counts as progress, at t of a run until t_end: above rounding, and large enough that
 *  the run takes less than 1e13 events. */
double pace_grain(double t, double t_end);

/** Count an event at t, or n steps to t. @return false: too many of them without progress */
bool pace_event(pace *pace, double t, double grain);
bool pace_steps(pace *pace, int n, double t, double grain);
/** Count n steps to t of a run until t_end. The limit is `most` in all, and a thousandth of it (at least 1e6) on a
 *  millionth of the run: at that rate the run would take a thousand times the limit. */
pace_budget pace_spend(pace *pace, int n, double t, double t_end, double most);
/** Record an event for pace_gathers(). */
void pace_note(pace *pace, double t, const dae_event *what);
/** Whether the last events were of the same kind, at decreasing intervals. @param within  time that they took [s] */
bool pace_gathers(const pace *pace, double *within);

void pace_keep(pace *pace, archive *archive);
