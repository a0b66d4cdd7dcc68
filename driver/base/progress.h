/** How far a run is: a line on a terminal that is drawn anew, elsewhere a line of a log now and then. Costs a decrement a step. */
#pragma once

#include <stdbool.h>

typedef struct progress {
    bool is_terminal;                /**< what stderr is */
    bool is_shown;                   /**< something stands on the terminal's line */
    double t_start, t_end;           /**< model time [s] */
    double interval;                 /**< clock [s]: between two lines */
    double started, looked, shown;   /**< clock [s]: of the start, the last look at the clock, the last line */
    unsigned long stride, countdown; /**< steps between looks at the clock; steps to the next one */
} progress;

/** Seconds of a clock that never goes back. */
double clock_seconds(void);

/** Whether stderr is a terminal, on which one line is drawn anew; else it goes to a log. */
bool progress_is_on_terminal(void);
/** [s] between two lines of a log: what EVOLVENT_PROGRESS_INTERVAL says, else a minute. */
double progress_log_interval(void);
/** Draw the terminal's line anew, or write a line with the date and time to the log. */
void progress_show(bool on_terminal, const char *text);
/** Wipe the terminal's line, so that a message can be written. */
void progress_wipe(void);
/** ", 1:23 left" or ", 4.5 h left"; "" if that is not known. */
void progress_left(char text[32], double seconds);

/** Begin a run from t_start to t_end. Nothing is ever shown if `enabled` is false. */
void progress_start(progress *progress, bool enabled, double t_start, double t_end);
/** For progress_step only: look at the clock, and show how far it is if it is time to. */
void progress_look(progress *progress, double t);
/** The run has ended: messages can be written. */
void progress_end(progress *progress);

static inline void progress_step(progress *progress, double t)
{
    if (--progress->countdown == 0) {
        progress_look(progress, t);
    }
}
