/** A line on a terminal that tells how far a run is. Costs a decrement a step. A leaf. */
#pragma once

#include <stdbool.h>

typedef struct progress {
    bool is_shown;                   /**< something stands on the line */
    double t_start, t_end;           /**< model time [s] */
    double started, looked, drawn;   /**< clock [s]: of the start, the last look at the clock, the last line */
    unsigned long stride, countdown; /**< steps between looks at the clock; steps to the next one */
} progress;

/** Seconds of a clock that never goes back. */
double clock_seconds(void);

/** Begin a run from t_start to t_end. Nothing is ever shown if `enabled` is false or stderr is no terminal. */
void progress_start(progress *progress, bool enabled, double t_start, double t_end);
/** For progress_step only: look at the clock, and draw the line if it is time to. */
void progress_look(progress *progress, double t);
/** Wipe the line, so that a message can be written. */
void progress_end(progress *progress);

static inline void progress_step(progress *progress, double t)
{
    if (--progress->countdown == 0) {
        progress_look(progress, t);
    }
}
