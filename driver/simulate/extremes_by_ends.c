#include "simulate/extremes_by_ends.h"

#include "base/peak.h"

#include <math.h>
#include <stdint.h>
#include <string.h>

void channel_past_init(channel_past *past, const extreme_channels *channels)
{
    *past = (channel_past){.values = extreme_channels_array(channels),
                           .older = extreme_channels_array(channels),
                           .ends = extreme_channels_array(channels),
                           .middle = extreme_channels_array(channels)};
}

void channel_past_serialize(channel_past *past, const extreme_channels *channels, archive *archive)
{
    SERIALIZE(archive, past->n_known);
    SERIALIZE(archive, past->t);
    SERIALIZE(archive, past->t_older);
    SERIALIZE_ARRAY(archive, past->values, channels->n_padded);
    SERIALIZE_ARRAY(archive, past->older, channels->n_padded);
    SERIALIZE_ARRAY(archive, past->ends, channels->n_padded);
    SERIALIZE_ARRAY(archive, past->middle, channels->n_padded);
}

/** Largest distance of a channel from the mean of both ends of a step, estimated from its changes in it and in the
 *  previous step: beyond the ends by the mean of both changes. */
static double reach_of(double older, double a, double b, double half_ratio)
{
    return fabs(b - a) + fabs(a - older) * half_ratio;
}

/** Whether any channel may have exceeded its extremes inside the step. Branch-free, since in most cases none has. */
static bool any_may_exceed(int n, const channel_past *past, double ratio, const double *restrict high,
                           const double *restrict low)
{
    const double *restrict older = past->older, *restrict from = past->values, *restrict to = past->ends;
    const double half_ratio = 0.5 * ratio;
    int64_t any = 0;
    for (int i = 0; i < n; i++) {
        const double a = from[i], b = to[i], mean = 0.5 * (a + b), reach = reach_of(older[i], a, b, half_ratio);
        any |= (int64_t)(mean + reach > high[i]) | (int64_t)(mean - reach < low[i]);
    }
    return any != 0;
}

/** Whether a channel is only an estimate at one of the ends, because it is far below its limit. */
static bool is_estimate(const channel_past *past, int i, double limit)
{
    const double lowest = fmin(past->older[i], fmin(past->values[i], past->ends[i]));
    return lowest > 0 && lowest <= DAE_NEAR * limit;
}

/** For a channel that may have exceeded an extreme: whether its slope, in the sense of the search, falls through zero
 *  inside the step. */
static bool may_turn(const channel_past *past, int i, int sense, double ratio, double limit)
{
    static const double margin = 0.5; /* relative to the change of the slope: the third derivative is unknown */
    if (past->n_known < 2 || (sense > 0 && is_estimate(past, i, limit))) {
        return true;
    }
    const double now = sense * (past->ends[i] - past->values[i]);
    const double before = sense * (past->values[i] - past->older[i]) * ratio;
    const double bend = (now - before) * 2 * ratio / (1 + ratio); /* change of the slope in the step */
    const double doubt = margin * fabs(bend);
    return now - 0.5 * bend + doubt >= 0 && now + 0.5 * bend - doubt <= 0;
}

/** The part of a step between two known ends: past.t and t[2]. */
typedef struct {
    extreme_channels *channels;
    channel_past *past;
    const integrate_step *step;
    double t[3];  /**< both ends and the middle */
    double ratio; /**< of its length to that of the previous one */
    enum { NOT_ASKED, KNOWN, UNKNOWN } middle;
} part;

/** Same check with both ends and the middle; if positive, search the extreme. */
static void take_middle(const part *part, int i, int sense)
{
    static const double margin = 0.1, first_width = 0.05;
    const channel_past *past = part->past;
    const double f[3] = {sense * past->values[i], sense * past->middle[i], sense * past->ends[i]};
    const double bend = fabs(f[0] - 2 * f[1] + f[2]), top = fmax(fmax(f[0], f[1]), f[2]);
    const double doubt = margin * (bend + fabs(f[2] - f[0]));
    const double slope_from = -3 * f[0] + 4 * f[1] - f[2], slope_to = f[0] - 4 * f[1] + 3 * f[2];
    if (top + bend <= extreme_channels_limit(part->channels, i, sense) || slope_from + doubt < 0 ||
        slope_to - doubt > 0) {
        return;
    }
    const double turn = peak_of_parabola(part->t, f);
    const extreme_bracket extreme = {.channel = i,
                                     .sense = sense,
                                     .left = part->t[0],
                                     .right = part->t[2],
                                     .start = isnan(turn) ? part->t[1] : fmin(fmax(turn, part->t[0]), part->t[2]),
                                     .width = first_width * (part->t[2] - part->t[0]),
                                     .expected = NAN};
    extreme_channels_climb(part->channels, part->step, &extreme);
}

/** Evaluate the middle, once. @return whether it is available */
static bool has_middle(part *part)
{
    if (part->middle == NOT_ASKED) {
        part->middle = extreme_channels_see(part->channels, part->step, part->t[1]) ? KNOWN : UNKNOWN;
        memcpy(part->past->middle, part->channels->values, (size_t)part->channels->n * sizeof(double));
    }
    return part->middle == KNOWN;
}

/** Process a channel that may have exceeded an extreme: update with its end, and search for a turning point. */
static void take_channel(part *part, int i)
{
    extreme_channels *channels = part->channels;
    const channel_past *past = part->past;
    const double a = past->values[i], b = past->ends[i], mean = 0.5 * (a + b);
    const double reach = reach_of(past->older[i], a, b, 0.5 * part->ratio);
    const bool may_be_low = mean - reach < channels->low[i];
    const bool may_be_high = mean + reach > channels->high[i];
    if (!may_be_low && !may_be_high) {
        return;
    }
    extreme_channels_take(channels, i, b, part->t[2]);
    if (may_be_low && may_turn(past, i, -1, part->ratio, -channels->low[i]) && has_middle(part)) {
        take_middle(part, i, -1);
    }
    if (may_be_high && may_turn(past, i, 1, part->ratio, channels->high[i]) && has_middle(part)) {
        take_middle(part, i, 1);
    }
}

static void take_ends(extreme_channels *channels, channel_past *past, const integrate_step *step, double to)
{
    const double ratio = past->n_known > 1 ? (to - past->t) / (past->t - past->t_older) : 1;
    if (past->n_known == 1) { /* assume the same change in the previous step */
        for (int i = 0; i < channels->n; i++) {
            past->older[i] = 2 * past->values[i] - past->ends[i];
        }
    }
    if (!any_may_exceed(channels->n_padded, past, ratio, channels->high, channels->low)) {
        return;
    }
    part part = {channels, past, step, {past->t, 0.5 * (past->t + to), to}, ratio, NOT_ASKED};
    for (int i = 0; i < channels->n; i++) {
        take_channel(&part, i);
    }
}

/** The end of the present step is the start of the next one. */
static void remember(channel_past *past, double t)
{
    double *free_values = past->older;
    past->older = past->values;
    past->values = past->ends;
    past->ends = free_values;
    past->t_older = past->t;
    past->t = t;
    past->n_known++;
}

static bool know_end(extreme_channels *channels, channel_past *past, const integrate_step *step, double t)
{
    const bool is_supplied = step->monitored != NULL && t >= step->t_to;
    const bool good = is_supplied || extreme_channels_know(channels, step, t);
    memcpy(past->ends, is_supplied ? step->monitored : channels->values, (size_t)channels->n * sizeof(double));
    return good;
}

void extremes_by_ends(extreme_channels *channels, channel_past *past, const integrate_step *step, double from,
                      double to)
{
    if (!step->continues || past->t < from) {
        past->n_known = 0;
    }
    if (past->n_known == 0 && from < to && extreme_channels_see(channels, step, from)) {
        memcpy(past->ends, channels->values, (size_t)channels->n * sizeof(double));
        remember(past, from);
    }
    if (past->n_known == 0) {
        if (extreme_channels_see(channels, step, to)) {
            memcpy(past->ends, channels->values, (size_t)channels->n * sizeof(double));
            remember(past, to);
        }
        return;
    }
    if (!know_end(channels, past, step, to)) {
        past->n_known = 0;
        return;
    }
    take_ends(channels, past, step, to);
    remember(past, to);
}
