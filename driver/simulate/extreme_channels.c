#include "simulate/extreme_channels.h"

#include "base/peak.h"

#include <math.h>
#include <stdint.h>
#include <string.h>

/** Round up to whole vectors of 8. */
static int padded(int n)
{
    return (n + 7) / 8 * 8;
}

double *extreme_channels_array(const extreme_channels *channels)
{
    return arena_calloc(channels->arena, (size_t)channels->n_padded, sizeof(double));
}

/** Few groups are all evaluated together: several often have their extreme at the same time. */
enum { FEW_GROUPS = 8 };

static void init_groups(extreme_channels *channels)
{
    const dae *dae = channels->dae;
    channels->group = -1;
    if (dae->n_groups <= FEW_GROUPS) {
        return;
    }
    channels->n_in_group = dae->n_monitored / dae->n_groups;
    channels->first_state = arena_calloc(channels->arena, (size_t)dae->n_groups + 1, sizeof(int));
    CLEANUP_FREE int *states = xcalloc((size_t)dae->n, sizeof(int));
    for (int group = 0; group < dae->n_groups; group++) {
        channels->first_state[group + 1] =
            channels->first_state[group] + dae->states_of_group(dae->self, group, states);
    }
    channels->states = arena_calloc(channels->arena, (size_t)channels->first_state[dae->n_groups], sizeof(int));
    for (int group = 0; group < dae->n_groups; group++) {
        (void)dae->states_of_group(dae->self, group, channels->states + channels->first_state[group]);
    }
}

void extreme_channels_init(extreme_channels *channels, const dae *dae, memory_arena *arena)
{
    *channels =
        (extreme_channels){.dae = dae, .arena = arena, .n = dae->n_monitored, .n_padded = padded(dae->n_monitored)};
    channels->high = extreme_channels_array(channels);
    channels->low = extreme_channels_array(channels);
    channels->high_time = extreme_channels_array(channels);
    channels->low_time = extreme_channels_array(channels);
    channels->values = extreme_channels_array(channels);
    channels->y = arena_calloc(arena, (size_t)dae->n, sizeof(double));
    for (int i = 0; i < channels->n_padded; i++) {
        channels->high[i] = INFINITY;
        channels->low[i] = -INFINITY;
    }
    init_groups(channels);
}

void extreme_channels_serialize(extreme_channels *channels, archive *archive)
{
    SERIALIZE(archive, channels->has_begun);
    SERIALIZE_ARRAY(archive, channels->high, channels->n_padded);
    SERIALIZE_ARRAY(archive, channels->low, channels->n_padded);
    SERIALIZE_ARRAY(archive, channels->high_time, channels->n_padded);
    SERIALIZE_ARRAY(archive, channels->low_time, channels->n_padded);
    SERIALIZE_ARRAY(archive, channels->values, channels->n_padded);
    SERIALIZE(archive, channels->t_values);
    SERIALIZE(archive, channels->group);
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

/** Whether any channel exceeds its limits. Branch-free, since in most cases none does. */
static bool any_passes(int n, const double *restrict values, const double *restrict high, const double *restrict low)
{
    int64_t any = 0;
    for (int i = 0; i < n; i++) {
        any |= (int64_t)(values[i] > high[i]) | (int64_t)(values[i] < low[i]);
    }
    return any != 0;
}

/** Evaluate the channels at a state. */
static bool ask(extreme_channels *channels, const dae_state *state, const double *known)
{
    char message[DAE_MESSAGE_LENGTH];
    const dae *dae = channels->dae;
    if (known != NULL) {
        memcpy(channels->values, known, (size_t)channels->n * sizeof(double));
        return true;
    }
    return dae->monitored(dae->self, state, channels->values, message) == DAE_OK;
}

static bool is_known(const extreme_channels *channels, double t, int group)
{
    return channels->t_values >= t && channels->t_values <= t && (channels->group < 0 || channels->group == group);
}

bool extreme_channels_know(extreme_channels *channels, const integrate_step *step, double t)
{
    const double time = t < step->t_to ? t : step->t_to; /* fmin is a function call */
    if (is_known(channels, time, -1)) {                  /* for example if several channels rise */
        return true;
    }
    channels->t_values = NAN;
    channels->group = -1;
    bool good;
    if (time < step->t_to) {
        dae_state state = *step->state;
        state.t = t;
        state.y = channels->y;
        good = step->interpolate(step->with, t, channels->y) && ask(channels, &state, NULL);
    } else {
        good = ask(channels, step->state, step->monitored);
    }
    if (good) {
        channels->t_values = time;
    }
    return good;
}

/** Update the extremes of all channels. */
static void take_all(extreme_channels *channels)
{
    channels->has_begun = true;
    if (any_passes(channels->n_padded, channels->values, channels->high, channels->low)) {
        for (int i = 0; i < channels->n; i++) {
            extreme_channels_take(channels, i, channels->values[i], channels->t_values);
        }
    }
}

/** Update the extremes of a group. */
static void take_group(extreme_channels *channels, int group)
{
    channels->has_begun = true;
    for (int i = group * channels->n_in_group; i < (group + 1) * channels->n_in_group; i++) {
        extreme_channels_take(channels, i, channels->values[i], channels->t_values);
    }
}

bool extreme_channels_see(extreme_channels *channels, const integrate_step *step, double t)
{
    if (!extreme_channels_know(channels, step, t)) {
        return false;
    }
    take_all(channels);
    return true;
}

/** Evaluate the channels of a group at a state. */
static bool ask_group(extreme_channels *channels, const dae_state *state, int group)
{
    char message[DAE_MESSAGE_LENGTH];
    const dae *dae = channels->dae;
    const bool good = dae->monitored_of_group(dae->self, group, state, channels->values, message) == DAE_OK;
    channels->group = group;
    channels->t_values = good ? state->t : NAN;
    return good;
}

bool extreme_channels_see_state(extreme_channels *channels, const dae_state *state, int channel)
{
    if (channels->n_in_group > 0 && channel >= 0) {
        const int group = channel / channels->n_in_group;
        const bool good = is_known(channels, state->t, group) || ask_group(channels, state, group);
        if (good) {
            take_group(channels, group);
        }
        return good;
    }
    if (!is_known(channels, state->t, -1)) {
        channels->group = -1;
        channels->t_values = NAN;
        if (!ask(channels, state, NULL)) {
            return false;
        }
        channels->t_values = state->t;
    }
    take_all(channels);
    return true;
}

/** Evaluate the channels of a group at a time in a step. @return false if they are not available there */
static bool know_group(extreme_channels *channels, const integrate_step *step, double time, int group)
{
    if (is_known(channels, time, group)) {
        return true;
    }
    channels->t_values = NAN;
    dae_state state = *step->state;
    if (time < step->t_to) {
        const int first = channels->first_state[group];
        state.t = time;
        state.y = channels->y;
        if (!step->interpolate_some(step->with, time, channels->first_state[group + 1] - first,
                                    channels->states + first, channels->y)) {
            return false;
        }
    }
    return ask_group(channels, &state, group);
}

/** As extreme_channels_see, for the group of a channel. */
static bool see_group_of(extreme_channels *channels, const integrate_step *step, double t, int channel)
{
    const double time = t < step->t_to ? t : step->t_to;
    if (channels->n_in_group == 0 || (step->monitored != NULL && time >= step->t_to)) {
        return extreme_channels_see(channels, step, t);
    }
    const int group = channel / channels->n_in_group;
    if (!know_group(channels, step, time, group)) {
        return false;
    }
    take_group(channels, group);
    return true;
}

double extreme_channels_limit(const extreme_channels *channels, int channel, int sense)
{
    return sense > 0 ? channels->high[channel] : -channels->low[channel];
}

/** A channel in a step, in the sense of the search. */
typedef struct {
    extreme_channels *channels;
    const integrate_step *step;
    int channel, sense;
} view;

/** Function to maximise: the channel multiplied by the sense. */
static double height(void *with, double t)
{
    const view *view = with;
    const bool is_seen = see_group_of(view->channels, view->step, t, view->channel);
    return is_seen ? view->sense * view->channels->values[view->channel] : NAN;
}

void extreme_channels_climb(extreme_channels *channels, const integrate_step *step, const extreme_bracket *extreme)
{
    view view = {channels, step, extreme->channel, extreme->sense};
    const peak_bracket bracket = {.left = extreme->left,
                                  .right = extreme->right,
                                  .start = extreme->start,
                                  .width = extreme->width,
                                  .expected = extreme->expected,
                                  .threshold = extreme_channels_limit(channels, extreme->channel, extreme->sense)};
    peak_climb(height, &view, &bracket);
}
