#include "simulate/number_channel.h"

#include <math.h>

static const double two_pi = 6.283185307179586;

void number_waves_find(number_waves *waves, int n_nodes, const double *xi, const double *rate)
{
    for (int k = 0; k < n_nodes; k++) {
        const double angle = two_pi * (xi[k] - floor(xi[k])), c = cos(angle), s = sin(angle);
        double cosine = 1, sine = 0;
        for (int n = 0; n < NUMBER_HARMONICS; n++) {
            const double next = cosine * c - sine * s;
            sine = sine * c + cosine * s;
            cosine = next;
            waves->wave[k][n] = cosine;
            waves->wave[k][NUMBER_HARMONICS + n] = sine;
        }
        waves->rate[k] = rate[k];
    }
}

static const channel_sums nothing = {.high = -INFINITY, .low = INFINITY};

void number_channel_init(number_channel *channel)
{
    *channel = (number_channel){.period = nothing, .total = nothing};
}

void number_channel_add(number_channel *channel, const step_nodes *nodes, const number_waves *waves, const double *x)
{
    if (!channel->has_begun) {
        channel->has_begun = true;
        channel->shift = x[0];
    }
    channel_sums *sums = &channel->period;
    for (int k = 0; k < nodes->n; k++) {
        const double d = x[k] - channel->shift, part = nodes->weight[k] * d;
        sums->power[0] += part;
        sums->power[1] += part * d;
        sums->power[2] += part * d * d;
        sums->power[3] += part * d * d * d;
        const double over_way = part * waves->rate[k];
        for (int n = 0; n < 2 * NUMBER_HARMONICS; n++) { /* harmonics side by side in vectors */
            sums->wave[n] += over_way * waves->wave[k][n];
        }
    }
    const channel_sums *total = &channel->total;
    const double beyond = sums->high > total->high ? sums->high : total->high;
    const double below = sums->low < total->low ? sums->low : total->low;
    const double high = step_nodes_peak(nodes, x, 1, beyond), low = -step_nodes_peak(nodes, x, -1, -below);
    sums->high = high > sums->high ? high : sums->high;
    sums->low = low < sums->low ? low : sums->low;
}

void number_channel_complete(number_channel *channel)
{
    channel_sums *total = &channel->total, *period = &channel->period;
    for (int i = 0; i < 4; i++) {
        total->power[i] += period->power[i];
    }
    for (int n = 0; n < 2 * NUMBER_HARMONICS; n++) {
        total->wave[n] += period->wave[n];
    }
    total->high = fmax(total->high, period->high);
    total->low = fmin(total->low, period->low);
    *period = nothing;
}

void number_channel_conclude(const number_channel *channel, double time, double pitches, channel_numbers *numbers)
{
    const channel_sums *sums = &channel->total;
    double m[4];
    for (int i = 0; i < 4; i++) {
        m[i] = sums->power[i] / time;
    }
    const double variance = fmax(m[1] - m[0] * m[0], 0), mean = channel->shift + m[0];
    const double fourth = m[3] - 4 * m[0] * m[2] + 6 * m[0] * m[0] * m[1] - 3 * m[0] * m[0] * m[0] * m[0];
    const double furthest = fmax(sums->high - mean, mean - sums->low);
    *numbers = (channel_numbers){.mean = mean,
                                 .deviation = sqrt(variance),
                                 .rms = sqrt(variance + mean * mean),
                                 .high = sums->high,
                                 .low = sums->low,
                                 .crest = variance > 0 ? furthest / sqrt(variance) : NAN,
                                 .kurtosis = variance > 0 ? fourth / (variance * variance) : NAN};
    for (int n = 0; n < NUMBER_HARMONICS; n++) {
        const double a = 2 * sums->wave[n] / pitches, b = 2 * sums->wave[NUMBER_HARMONICS + n] / pitches;
        numbers->amplitude[n] = hypot(a, b);
        numbers->phase[n] = atan2(b, a);
    }
}
