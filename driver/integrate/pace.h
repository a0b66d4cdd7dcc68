/** Whether a run gets on: events and steps without progress, and events that come ever sooner. */
#pragma once

#include "base/archive.h"
#include "integrate/dae.h"

enum { PACE_RECENT = 9 };

typedef struct {
    double t_began;               /**< time from which on there was no progress */
    int events, steps;            /**< since then */
    double t_recent[PACE_RECENT]; /**< of the last events that were alike, the latest last */
    int n_recent;
    dae_event last;
} pace;

/** Nothing has happened. */
pace pace_create(void);
/** Times closer than this are no progress, at t of a run until t_end: to rounding, or so that the run would take 1e13 events. */
double pace_grain(double t, double t_end);

/** An event, or a step, at t. @return false: too many of them without progress */
bool pace_event(pace *pace, double t, double grain);
bool pace_step(pace *pace, double t, double grain);
/** What an event was, for pace_gathers(). */
void pace_note(pace *pace, double t, const dae_event *what);
/** Whether the last events were alike and came ever sooner. @param within  time that they took [s] */
bool pace_gathers(const pace *pace, double *within);

void pace_keep(pace *pace, archive *archive);
