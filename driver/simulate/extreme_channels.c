#include "simulate/extreme_channels.h"

#include "base/peak.h"

#include <math.h>
#include <stdint.h>
#include <string.h>

/** Vectors of 8 take them all. */
static int padded(int n)
{
    return (n + 7) / 8 * 8;
}

double *extreme_channels_array(const extreme_channels *channels)
{
    return pool_calloc(channels->pool, (size_t)channels->n_padded, sizeof(double));
}

void extreme_channels_init(extreme_channels *channels, const dae *dae, memory_pool *pool)
{
    *channels = (extreme_channels){.dae = dae, .pool = pool, .n = dae->n_watched, .n_padded = padded(dae->n_watched)};
    channels->high = extreme_channels_array(channels);
    channels->low = extreme_channels_array(channels);
    channels->high_time = extreme_channels_array(channels);
    channels->low_time = extreme_channels_array(channels);
    channels->values = extreme_channels_array(channels);
    channels->y = pool_calloc(pool, (size_t)dae->n, sizeof(double));
    for (int i = 0; i < channels->n_padded; i++) {
        channels->high[i] = INFINITY;
        channels->low[i] = -INFINITY;
    }
}

void extreme_channels_take(extreme_channels *channels, int channel, double value, double t)
{
    if (value > channels->high[channel]) {
        channels->high[channel] = value;
        channels->high_time[channel] = t;
    }
    if (value < channels->low[channel]) {
        channels->low[channel] = value;
        channels->low_time[channel] = t;
    }
}

/** Whether any channel passes its limits. A loop without a branch, since most often none does. */
static bool any_passes(int n, const double *restrict values, const double *restrict high, const double *restrict low)
{
    int64_t any = 0;
    for (int i = 0; i < n; i++) {
        any |= (int64_t)(values[i] > high[i]) | (int64_t)(values[i] < low[i]);
    }
    return any != 0;
}

/** The channels at a state. */
static bool ask(extreme_channels *channels, const dae_state *state, const double *known)
{
    char message[DAE_MESSAGE_LENGTH];
    const dae *dae = channels->dae;
    if (known != NULL) {
        memcpy(channels->values, known, (size_t)channels->n * sizeof(double));
        return true;
    }
    return dae->watched(dae->self, state, channels->values, message) == DAE_OK;
}

bool extreme_channels_know(extreme_channels *channels, const integrate_step *step, double t)
{
    const double place = t < step->t_to ? t : step->t_to;             /* fmin is a call */
    if (channels->t_values >= place && channels->t_values <= place) { /* as where several channels rise */
        return true;
    }
    channels->t_values = NAN;
    bool good;
    if (place < step->t_to) {
        dae_state state = *step->state;
        state.t = t;
        state.y = channels->y;
        good = step->interpolate(step->with, t, channels->y) && ask(channels, &state, NULL);
    } else {
        good = ask(channels, step->state, step->watched);
    }
    if (good) {
        channels->t_values = place;
    }
    return good;
}

bool extreme_channels_see(extreme_channels *channels, const integrate_step *step, double t)
{
    if (!extreme_channels_know(channels, step, t)) {
        return false;
    }
    channels->has_begun = true;
    if (any_passes(channels->n_padded, channels->values, channels->high, channels->low)) {
        for (int i = 0; i < channels->n; i++) {
            extreme_channels_take(channels, i, channels->values[i], channels->t_values);
        }
    }
    return true;
}

double extreme_channels_limit(const extreme_channels *channels, int channel, int sense)
{
    return sense > 0 ? channels->high[channel] : -channels->low[channel];
}

/** A channel in a step, looked at in one sense. */
typedef struct {
    extreme_channels *channels;
    const integrate_step *step;
    int channel, sense;
} view;

/** The larger, the nearer to an extreme. */
static double height(void *with, double t)
{
    const view *view = with;
    return extreme_channels_see(view->channels, view->step, t) ? view->sense * view->channels->values[view->channel]
                                                               : NAN;
}

void extreme_channels_climb(extreme_channels *channels, const integrate_step *step, const extreme_place *place)
{
    view view = {channels, step, place->channel, place->sense};
    const peak_bracket bracket = {.left = place->left,
                                  .right = place->right,
                                  .start = place->start,
                                  .width = place->width,
                                  .expected = place->expected,
                                  .wanted = extreme_channels_limit(channels, place->channel, place->sense)};
    peak_climb(height, &view, &bracket);
}
