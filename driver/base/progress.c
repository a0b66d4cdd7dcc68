#include "base/progress.h"

#include "base/log.h"
#include "base/number.h"

#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>
#include <unistd.h>

static const double terminal_interval = 0.1; /* [s] between two lines on a terminal */
static const double log_interval = 60.0;     /* [s] between two lines in a log */
static const double look_interval = 0.02;    /* [s] between two readings of the clock, target */
static const double growth = 4.0;            /* largest factor on the stride, because the cost of steps varies */

double clock_seconds(void)
{
    struct timespec now;
    (void)clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* ---- lines ---- */

bool progress_is_on_terminal(void)
{
    return isatty(STDERR_FILENO) == 1;
}

double progress_log_interval(void)
{
    const char *text = getenv("EVOLVENT_PROGRESS_INTERVAL");
    double seconds = 0.0;
    return text != NULL && number_read(text, &seconds) == NUMBER_FINITE && seconds > 0.0 ? seconds : log_interval;
}

void progress_show(bool on_terminal, const char *text)
{
    if (on_terminal) {
        fprintf(stderr, "\r%s\x1b[K", text);
    } else {
        char stamp[32] = "";
        const time_t now = time(NULL);
        struct tm local;
        if (localtime_r(&now, &local) != NULL) {
            (void)strftime(stamp, sizeof stamp, "%Y-%m-%d %H:%M:%S", &local);
        }
        log_note("%s  %s", stamp, text);
    }
    (void)fflush(stderr);
}

void progress_wipe(void)
{
    fputs("\r\x1b[K", stderr);
    (void)fflush(stderr);
}

void progress_left(char text[32], double seconds)
{
    text[0] = '\0';
    if (seconds < 3600.0) {
        (void)snprintf(text, 32, ", %d:%02d left", (int)seconds / 60, (int)seconds % 60);
    } else if (isfinite(seconds)) {
        (void)snprintf(text, 32, ", %.1f h left", seconds / 3600.0);
    }
}

/* ---- a run ---- */

void progress_start(progress *progress, bool enabled, double t_start, double t_end)
{
    const double now = clock_seconds();
    const bool is_terminal = progress_is_on_terminal();
    *progress = (struct progress){.is_terminal = is_terminal,
                                  .t_start = t_start,
                                  .t_end = t_end,
                                  .interval = is_terminal ? terminal_interval : progress_log_interval(),
                                  .started = now,
                                  .looked = now,
                                  .shown = now};
    progress->stride = enabled ? 16 : ULONG_MAX;
    progress->countdown = progress->stride;
}

static void show(const progress *progress, double t, double now)
{
    const double rate = (t - progress->t_start) / (now - progress->started);
    const double fraction = (t - progress->t_start) / (progress->t_end - progress->t_start);
    char left[32], text[128];
    progress_left(left, rate > 0.0 ? (progress->t_end - t) / rate : INFINITY);
    (void)snprintf(text, sizeof text, "%5.1f %%  t = %.5g of %.5g s, %.3g s per s%s", 100.0 * fraction, t,
                   progress->t_end, rate, left);
    progress_show(progress->is_terminal, text);
}

void progress_look(progress *progress, double t)
{
    const double now = clock_seconds();
    const double factor = look_interval / (now - progress->looked + 1e-9);
    const double stride = (double)progress->stride * (factor > growth ? growth : factor);
    progress->stride = stride < 1.0 ? 1 : stride > 1e9 ? 1000000000UL : (unsigned long)stride;
    progress->countdown = progress->stride;
    progress->looked = now;
    if (now - progress->shown >= progress->interval) {
        show(progress, t, now);
        progress->shown = now;
        progress->is_shown = progress->is_terminal;
    }
}

void progress_end(progress *progress)
{
    if (progress->is_shown) {
        progress_wipe();
        progress->is_shown = false;
    }
}
