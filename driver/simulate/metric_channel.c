#include "simulate/metric_channel.h"

#include "simulate/each_processor.h"

#include <math.h>
#include <string.h>

/* These loops take a third of the time spent on metrics. */

static const double two_pi = 6.283185307179586;

/** Cosine and sine of a small angle [rad], |x| < 0.3: exact to rounding, without a function call. */
static inline void small_turn(double x, double *cosine, double *sine)
{
    const double q = x * x;
    *cosine = 1 - q / 2 * (1 - q / 12 * (1 - q / 30 * (1 - q / 56 * (1 - q / 90))));
    *sine = x * (1 - q / 6 * (1 - q / 20 * (1 - q / 42 * (1 - q / 72 * (1 - q / 110)))));
}

/** Cosines and sines of the first harmonic at the nodes, from a nearby position. */
static inline void find_first_wave(metric_waves *waves, int n_nodes, const double *xi, double *cosines, double *sines)
{
    static const double small = 0.04; /* pitches */
    if (!(fabs(xi[0] - waves->near) < small && fabs(xi[n_nodes - 1] - waves->near) < small)) {
        const double angle = two_pi * (xi[0] - floor(xi[0]));
        waves->near = xi[0];
        waves->cosine = cos(angle);
        waves->sine = sin(angle);
    }
    const double c = waves->cosine, s = waves->sine, near = waves->near;
    double furthest = 0;
    for (int k = 0; k < n_nodes; k++) {
        const double distance = fabs(xi[k] - near);
        furthest = distance > furthest ? distance : furthest;
    }
    for (int k = 0; k < n_nodes && furthest < small; k++) {
        double cosine, sine;
        small_turn(two_pi * (xi[k] - near), &cosine, &sine);
        cosines[k] = c * cosine - s * sine;
        sines[k] = s * cosine + c * sine;
    }
    for (int k = 0; k < n_nodes && !(furthest < small); k++) {
        const double here = two_pi * (xi[k] - floor(xi[k]));
        cosines[k] = cos(here);
        sines[k] = sin(here);
    }
}

void metric_waves_init(metric_waves *waves)
{
    *waves = (metric_waves){.cosine = 1};
}

FOR_EACH_PROCESSOR void metric_waves_find(metric_waves *waves, int n_nodes, const double *xi, const double *rate)
{
    enum { N = METRIC_HARMONICS };
    double c[STEP_NODES_MOST] = {0}, s[STEP_NODES_MOST] = {0};
    find_first_wave(waves, n_nodes, xi, c, s);
    for (int k = 0; k < n_nodes; k++) {
        waves->wave[0][k] = c[k];
        waves->wave[N][k] = s[k];
        waves->rate[k] = rate[k];
    }
    for (int n = 1; n < N; n++) { /* computed from the harmonics of half its order, for short dependency chains */
        const double *c_1 = waves->wave[n / 2], *s_1 = waves->wave[N + n / 2];
        const double *c_2 = waves->wave[(n - 1) / 2], *s_2 = waves->wave[N + (n - 1) / 2];
        double c_n[STEP_NODES_MOST], s_n[STEP_NODES_MOST];
        for (int k = 0; k < STEP_NODES_MOST; k++) {
            c_n[k] = c_1[k] * c_2[k] - s_1[k] * s_2[k];
            s_n[k] = s_1[k] * c_2[k] + c_1[k] * s_2[k];
        }
        memcpy(waves->wave[n], c_n, sizeof c_n);
        memcpy(waves->wave[N + n], s_n, sizeof s_n);
    }
}

static const channel_sums nothing = {.high = -INFINITY, .low = INFINITY};

void metric_channel_init(metric_channel *channel)
{
    *channel = (metric_channel){.period = nothing, .total = nothing};
}

/** Add to the sums of each node separately: no sum changes its order, whatever the vector length.
 *  Equation N5. */
FOR_EACH_PROCESSOR static void add_at_nodes(channel_sums *restrict sums, double shift, const double *restrict weight,
                                            const metric_waves *restrict waves, const double *restrict x)
{
    double over_position[STEP_NODES_MOST];
    for (int k = 0; k < STEP_NODES_MOST; k++) {
        const double d = x[k] - shift, part = weight[k] * d;
        sums->power[0][k] += part;
        sums->power[1][k] += part * d;
        sums->power[2][k] += part * d * d;
        sums->power[3][k] += part * d * d * d;
        over_position[k] = part * waves->rate[k];
    }
    for (int h = 0; h < 2 * METRIC_HARMONICS; h++) {
        for (int k = 0; k < STEP_NODES_MOST; k++) {
            sums->wave[h][k] += over_position[k] * waves->wave[h][k];
        }
    }
}

void metric_channel_add(metric_channel *channel, const step_nodes *nodes, const metric_waves *waves, const double *x)
{
    channel_sums *sums = &channel->period;
    const channel_sums *total = &channel->total;
    double padded[STEP_NODES_MOST];
    for (int k = 0; k < STEP_NODES_MOST && nodes->n < STEP_NODES_MOST; k++) {
        padded[k] = x[k < nodes->n ? k : 0]; /* with zero weight */
    }
    if (!channel->has_begun) {
        channel->has_begun = true;
        channel->shift = x[0];
    }
    add_at_nodes(sums, channel->shift, nodes->weight, waves, nodes->n < STEP_NODES_MOST ? padded : x);
    const double beyond = sums->high > total->high ? sums->high : total->high;
    const double below = sums->low < total->low ? sums->low : total->low;
    const node_range range = step_nodes_range(nodes, x);
    if (range.may_reach > beyond) {
        sums->high = fmax(sums->high, step_nodes_peak(nodes, x, 1));
    }
    if (range.may_fall < below) {
        sums->low = fmin(sums->low, -step_nodes_peak(nodes, x, -1));
    }
}

/** Add one set of sums to another. */
static void add_sums(channel_sums *sums, const channel_sums *more)
{
    for (int k = 0; k < STEP_NODES_MOST; k++) {
        for (int i = 0; i < 4; i++) {
            sums->power[i][k] += more->power[i][k];
        }
        for (int h = 0; h < 2 * METRIC_HARMONICS; h++) {
            sums->wave[h][k] += more->wave[h][k];
        }
    }
    sums->high = fmax(sums->high, more->high);
    sums->low = fmin(sums->low, more->low);
}

static double sum_of(const double of_nodes[STEP_NODES_MOST])
{
    double sum = 0;
    for (int k = 0; k < STEP_NODES_MOST; k++) {
        sum += of_nodes[k];
    }
    return sum;
}

double metric_channel_complete(metric_channel *channel)
{
    const double integral = sum_of(channel->period.power[0]);
    add_sums(&channel->total, &channel->period);
    channel->period = nothing;
    return integral;
}

channel_window metric_channel_conclude(const metric_channel *channel, double time, double pitches, double least)
{
    const channel_sums *sums = &channel->total;
    double m[4];
    for (int i = 0; i < 4; i++) {
        m[i] = sum_of(sums->power[i]) / time;
    }
    const double variance = fmax(m[1] - m[0] * m[0], 0), mean = channel->shift + m[0];
    const bool has_values = sums->high >= sums->low; /* there are none if the quantity is NaN */
    channel_window window = {.mean = mean,
                             .variance = variance,
                             .rms = sqrt(variance + mean * mean),
                             .fourth = m[3] - 4 * m[0] * m[2] + 6 * m[0] * m[0] * m[1] - 3 * m[0] * m[0] * m[0] * m[0],
                             .high = has_values ? sums->high : NAN,
                             .low = has_values ? sums->low : NAN,
                             .least = least};
    for (int n = 0; n < METRIC_HARMONICS; n++) {
        window.cosine[n] = 2 * sum_of(sums->wave[n]) / pitches;
        window.sine[n] = 2 * sum_of(sums->wave[METRIC_HARMONICS + n]) / pitches;
    }
    return window;
}
