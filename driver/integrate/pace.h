/** Whether a run gets on: events and steps without progress, and events that come ever sooner. */
#pragma once

#include "base/archive.h"
#include "integrate/dae.h"

enum { PACE_RECENT = 9 };

typedef struct {
    double t_began;               /**< time from which on there was no progress */
    int events, steps;            /**< since then */
    double all;                   /**< steps of the run so far */
    double t_crept, crept;        /**< where a stretch of the run began, and the steps on it */
    double t_recent[PACE_RECENT]; /**< of the last events that were alike, the latest last */
    int n_recent;
    dae_event last;
} pace;

/** What is left of a run's steps: some; none; or it creeps. */
typedef enum { PACE_FITS, PACE_SPENT, PACE_CREEPS } pace_budget;

/** Nothing has happened. */
pace pace_create(void);
/** Times closer than this are no progress, at t of a run until t_end: to rounding, or so that the run would take 1e13 events. */
double pace_grain(double t, double t_end);

/** An event at t, or n steps to there. @return false: too many of them without progress */
bool pace_event(pace *pace, double t, double grain);
bool pace_steps(pace *pace, int n, double t, double grain);
/** n steps to t of a run until t_end: there may be `most` of them in all, and a thousandth of these, or 1e6, on a millionth of the run:
 *  at that pace it would take a thousand times what it may. */
pace_budget pace_spend(pace *pace, int n, double t, double t_end, double most);
/** What an event was, for pace_gathers(). */
void pace_note(pace *pace, double t, const dae_event *what);
/** Whether the last events were alike and came ever sooner. @param within  time that they took [s] */
bool pace_gathers(const pace *pace, double *within);

void pace_keep(pace *pace, archive *archive);
