/* Integration alone, without outputs and files, timed by benchmarks/lanes.py. */
#include <evolvent/kernel.h>
#include <stdlib.h>
#include <string.h>

int lanes_integrate(const evl_gearbox *gearbox, evl_radau *radau, const double *start, const int *start_integers,
                    const double *start_reals, double duration, int n_outputs, double *outputs);

/** Integrate from t = 0 and interpolate to a grid: outputs [n_outputs][n_states]. @return code of the first call that failed */
int lanes_integrate(const evl_gearbox *gearbox, evl_radau *radau, const double *start, const int *start_integers,
                    const double *start_reals, double duration, int n_outputs, double *outputs)
{
    evl_sizes sizes;
    evl_gearbox_sizes(gearbox, &sizes);
    const size_t n = (size_t)sizes.n_states, n_integers = (size_t)sizes.n_integers, n_reals = (size_t)sizes.n_reals;
    double *reals = calloc(2 * n + n_reals, sizeof *reals);
    int *integers = calloc(n_integers + (size_t)sizes.n_roots, sizeof *integers);
    evl_event *events = calloc((size_t)sizes.n_events, sizeof *events);
    int code = EVL_NO_MEMORY;
    if (reals != NULL && integers != NULL && events != NULL) {
        double *y = reals + n_reals, *yp = y + n, t = 0;
        int *fired = integers + n_integers, outcome = EVL_RADAU_STEP, next = 0, n_events = 0;
        memcpy(y, start, n * sizeof *y);
        memcpy(reals, start_reals, n_reals * sizeof *reals);
        memcpy(integers, start_integers, n_integers * sizeof *integers);
        code = evl_radau_start(radau, t, y, integers, reals, NULL);
        while (code == EVL_OK && outcome != EVL_RADAU_STOP) {
            code = evl_radau_advance(radau, duration, &t, y, fired, &outcome, NULL);
            for (; next < n_outputs && duration * next / (n_outputs - 1) <= t; next++) {
                evl_radau_interpolate(radau, duration * next / (n_outputs - 1), outputs + (size_t)next * n);
            }
            if (code == EVL_OK && outcome == EVL_RADAU_EVENT) {
                code =
                    evl_gearbox_apply_event(gearbox, t, fired, false, y, yp, integers, reals, events, &n_events, NULL);
                evl_radau_restart(radau, t, y, integers, reals);
            }
        }
    }
    free(reals);
    free(integers);
    free(events);
    return code;
}
