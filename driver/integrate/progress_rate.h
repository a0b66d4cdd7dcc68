/** Progress monitor of a run: events and steps without progress, and accumulating events. */
#pragma once

#include "base/archive.h"
#include "integrate/dae.h"

enum { PROGRESS_RATE_RECENT = 9 };

typedef struct {
    double t_began;                        /**< time since which there was no progress */
    int events, steps;                     /**< since then */
    double all;                            /**< steps of the run so far */
    double t_crept, crept;                 /**< start of the present stretch of the run, and the steps on it */
    double t_recent[PROGRESS_RATE_RECENT]; /**< of the last events of the same kind, the latest last */
    int n_recent;
    dae_event last;
} progress_rate;

/** State of a run's step budget: sufficient; exhausted; or too slow. */
typedef enum { BUDGET_FITS, BUDGET_SPENT, BUDGET_TOO_SLOW } step_budget;

/** Initial state. */
progress_rate progress_rate_create(void);
/** Smallest time increment that counts as progress, at t of a run until t_end: above rounding, and large enough that
 *  the run takes less than 1e13 events. */
double progress_rate_resolution(double t, double t_end);

/** Count an event at t, or n steps to t. @return false: too many of them without progress */
bool progress_rate_event(progress_rate *progress_rate, double t, double grain);
bool progress_rate_steps(progress_rate *progress_rate, int n, double t, double grain);
/** Count n steps to t of a run until t_end. The limit is `most` in all, and a thousandth of it (at least 1e6) on a
 *  millionth of the run: at that rate the run would take a thousand times the limit. */
step_budget progress_rate_spend(progress_rate *progress_rate, int n, double t, double t_end, double most);
/** Record an event for progress_rate_accumulates(). */
void progress_rate_note(progress_rate *progress_rate, double t, const dae_event *what);
/** Whether the last events were of the same kind, at decreasing intervals. @param within  time that they took [s] */
bool progress_rate_accumulates(const progress_rate *progress_rate, double *within);

void progress_rate_serialize(progress_rate *progress_rate, archive *archive);
