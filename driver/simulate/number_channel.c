#include "simulate/number_channel.h"

#include <math.h>

static const double two_pi = 6.283185307179586;

/** Cosine and sine of a small angle [rad], |x| < 0.3: exact to rounding, and no call. */
static void small_turn(double x, double *cosine, double *sine)
{
    const double q = x * x;
    *cosine = 1 - q / 2 * (1 - q / 12 * (1 - q / 30 * (1 - q / 56 * (1 - q / 90))));
    *sine = x * (1 - q / 6 * (1 - q / 20 * (1 - q / 42 * (1 - q / 72 * (1 - q / 110)))));
}

void number_waves_find(number_waves *waves, int n_nodes, const double *xi, const double *rate)
{
    static const double small = 0.04; /* pitches */
    double c = 1, s = 0, before = NAN;
    for (int k = 0; k < n_nodes; k++) {
        if (fabs(xi[k] - before) < small) { /* on from the node before */
            double cosine, sine;
            small_turn(two_pi * (xi[k] - before), &cosine, &sine);
            const double turned = c * cosine - s * sine;
            s = s * cosine + c * sine;
            c = turned;
        } else {
            const double angle = two_pi * (xi[k] - floor(xi[k]));
            c = cos(angle);
            s = sin(angle);
        }
        before = xi[k];
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

/** Add a sum over the nodes to each of the waves; with a number of nodes that the compiler knows it takes harmonics in vectors. */
static inline void add_waves(int n, const double over_way[STEP_NODES_MOST], const number_waves *waves, double *sums)
{
    for (int h = 0; h < 2 * NUMBER_HARMONICS; h++) {
        double sum = 0;
        for (int k = 0; k < n; k++) {
            sum += over_way[k] * waves->wave[k][h];
        }
        sums[h] += sum;
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
    double over_way[STEP_NODES_MOST];
    for (int k = 0; k < nodes->n; k++) {
        const double d = x[k] - channel->shift, part = nodes->weight[k] * d;
        sums->power[0] += part;
        sums->power[1] += part * d;
        sums->power[2] += part * d * d;
        sums->power[3] += part * d * d * d;
        over_way[k] = part * waves->rate[k];
    }
    if (nodes->n == STEP_NODES_MOST) {
        add_waves(STEP_NODES_MOST, over_way, waves, sums->wave);
    } else {
        add_waves(nodes->n, over_way, waves, sums->wave);
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
