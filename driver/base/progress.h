/** Progress of a run: one updated line on a terminal, else a log line at intervals. Costs one decrement a step. */
#pragma once

#include <stdbool.h>

typedef struct progress {
    bool is_terminal;                /**< whether stderr is a terminal */
    bool is_shown;                   /**< the terminal's line is not empty */
    double t_start, t_end;           /**< model time [s] */
    double interval;                 /**< wall clock [s]: between two lines */
    double started, looked, shown;   /**< wall clock [s]: of the start, the last reading of the clock, the last line */
    unsigned long stride, countdown; /**< steps between readings of the clock; steps to the next one */
} progress;

/** Seconds of a monotonic clock. */
double clock_seconds(void);

/** Whether stderr is a terminal, on which one line is updated; else it is a log. */
bool progress_is_on_terminal(void);
/** [s] between two log lines: the value of EVOLVENT_PROGRESS_INTERVAL, else a minute. */
double progress_log_interval(void);
/** Update the terminal's line, or write a line with date and time to the log. */
void progress_show(bool on_terminal, const char *text);
/** Clear the terminal's line before a message is written. */
void progress_wipe(void);
/** ", 1:23 left" or ", 4.5 h left"; "" if unknown. */
void progress_left(char text[32], double seconds);

/** Start a run from t_start to t_end. No output if `enabled` is false. */
void progress_start(progress *progress, bool enabled, double t_start, double t_end);
/** For progress_step only: read the clock and show the progress if it is due. */
void progress_look(progress *progress, double t);
/** End the run, so that messages can be written. */
void progress_end(progress *progress);

static inline void progress_step(progress *progress, double t)
{
    if (--progress->countdown == 0) {
        progress_look(progress, t);
    }
}
