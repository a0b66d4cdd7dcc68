#include "base/progress.h"

#include <limits.h>
#include <stdio.h>
#include <time.h>
#include <unistd.h>

static const double draw_interval = 0.1;  /* [s] between two lines */
static const double look_interval = 0.02; /* [s] between two looks at the clock, aimed at */
static const double growth = 4.0;         /* of the stride at most, because steps do not all cost the same */

double clock_seconds(void)
{
    struct timespec now;
    (void)clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

void progress_start(progress *progress, bool enabled, double t_start, double t_end)
{
    const bool is_on = enabled && isatty(STDERR_FILENO) == 1;
    const double now = is_on ? clock_seconds() : 0.0;
    *progress = (struct progress){.t_start = t_start, .t_end = t_end, .started = now, .looked = now, .drawn = now};
    progress->stride = is_on ? 16 : ULONG_MAX;
    progress->countdown = progress->stride;
}

static void draw(const progress *progress, double t, double now)
{
    const double rate = (t - progress->t_start) / (now - progress->started);
    const double fraction = (t - progress->t_start) / (progress->t_end - progress->t_start);
    char left[32] = "";
    if (rate > 0.0) {
        const double seconds = (progress->t_end - t) / rate;
        if (seconds < 3600.0) {
            (void)snprintf(left, sizeof left, ", %d:%02d left", (int)seconds / 60, (int)seconds % 60);
        } else {
            (void)snprintf(left, sizeof left, ", %.1f h left", seconds / 3600.0);
        }
    }
    fprintf(stderr, "\r%5.1f %%  t = %.5g of %.5g s, %.3g s per s%s\x1b[K", 100.0 * fraction, t, progress->t_end, rate,
            left);
    (void)fflush(stderr);
}

void progress_look(progress *progress, double t)
{
    const double now = clock_seconds();
    const double factor = look_interval / (now - progress->looked + 1e-9);
    const double stride = (double)progress->stride * (factor > growth ? growth : factor);
    progress->stride = stride < 1.0 ? 1 : stride > 1e9 ? 1000000000UL : (unsigned long)stride;
    progress->countdown = progress->stride;
    progress->looked = now;
    if (now - progress->drawn >= draw_interval) {
        draw(progress, t, now);
        progress->drawn = now;
        progress->is_shown = true;
    }
}

void progress_end(progress *progress)
{
    if (progress->is_shown) {
        fputs("\r\x1b[K", stderr);
        (void)fflush(stderr);
        progress->is_shown = false;
    }
}
