#include "respond/settling.h"

#include "model/model_modes.h"

#include <math.h>
#include <stdlib.h>

static const double rounding = 0.01; /* relative to the distance below which states are regarded as equal: the error of
                                      * the integration */

settling_times settling_of(const model *model)
{
    enum { POSITIONS = 31 };
    static const double undamped = 1e-6, aperiodic = 1; /* damping ratio; imaginary over real part */
    settling_times times = {0, 0};
    dae_state state;
    natural_modes modes;
    model_message refusal;
    CLEANUP_FREE double *values = xcalloc((size_t)model_about(model)->n_values, sizeof *values);
    if (!model_mean_modes(model, POSITIONS, &state, values, &modes, &refusal)) {
        return times;
    }
    for (int i = 0; i < modes.n; i++) {
        const double complex eigenvalue = modes.modes[i].eigenvalue;
        const double decay = -creal(eigenvalue), frequency = cimag(eigenvalue);
        if (decay > undamped * cabs(eigenvalue)) {
            times.slowest = fmax(times.slowest, 1 / decay);
            times.half_turn =
                frequency > aperiodic * decay ? fmax(times.half_turn, acos(-1.0) / frequency) : times.half_turn;
        }
    }
    arena_free(&modes.arena);
    dae_state_free(&state);
    return times;
}

int settling_most(const settling_times *times, int pitches, double time)
{
    /* from 1000 scales down to 1e-6, and further to the small changes of a slow mode; more pitches are not worthwhile */
    static const double constants = 25, most_pitches = 20000;
    const int usual = ORBIT_USUAL_PERIODS / pitches;
    const int least = usual > ORBIT_LEAST_PERIODS ? usual : ORBIT_LEAST_PERIODS;
    const double needed = fmin(ceil(constants * times->slowest / time), floor(most_pitches / pitches));
    return needed > least ? (int)needed : least;
}

void settling_restart(settling *s)
{
    for (int p = 0; p <= ORBIT_LONGEST; p++) {
        s->calm[p] = 0;
        s->largest[0][p] = s->largest[1][p] = NAN;
    }
}

void settling_begin(settling *s, const settling_times *times, double repeats, int most, int pitches, double time,
                    int window)
{
    *s = (settling){.times = *times,
                    .is_open = most == 0,
                    .pitches = pitches,
                    .window = window,
                    .repeats = repeats,
                    .last = (most > 0 ? most : settling_most(times, pitches, time)) - window,
                    .turn = 1};
    settling_restart(s);
}

void settling_pass(settling *s, int periods, double time, const double *distances)
{
    if (s->is_open) {
        s->last = settling_most(&s->times, s->pitches, time) - s->window;
    }
    const double turn = ceil(s->times.half_turn / time);
    s->turn = turn < s->last ? (int)turn : s->last;
    for (int p = 1; p <= ORBIT_LONGEST; p++) {
        const double grows = s->times.slowest > 0 ? expm1(p * time / s->times.slowest) : INFINITY;
        const double allowed = s->repeats * fmax(fmin(grows, 1), rounding);
        s->calm[p] = distances[p] <= allowed ? s->calm[p] + 1 : 0;
        const int quarter = (int)(4.0 * periods / s->last) - 2;
        if (quarter >= 0) {
            double *largest = &s->largest[quarter < 1 ? quarter : 1][p];
            *largest = fmax(*largest, distances[p]);
        }
    }
}

bool settling_is_slow(const settling *s, double time)
{
    static const double many = 20;
    return s->times.slowest > many * time;
}

bool settling_is_calm(const settling *s, int orbit)
{
    return s->calm[orbit] >= (s->is_on_orbit ? 1 : s->turn);
}

bool settling_goes_on(const settling *s, double time)
{
    static const double few = 3, shrinks = 0.7; /* in time constants; e^(-3/4), for a quarter of them, is smaller */
    int nearest = 1;
    for (int p = 2; p <= ORBIT_LONGEST; p++) {
        nearest = s->largest[1][p] < s->largest[1][nearest] ? p : nearest;
    }
    const double before = s->largest[0][nearest];
    return time < few * s->times.slowest || isnan(before) || s->largest[1][nearest] < shrinks * before;
}
