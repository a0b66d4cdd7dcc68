#include "simulate/root_ranges.h"

#include <math.h>

enum { POINTS = 2 * MODEL_ROOT_POINTS }; /* of both fillets of a tooth */

/** Number of extremes of all wheels. */
static int count(const root_ranges *self)
{
    return self->n_wheels * POINTS * 2;
}

void root_ranges_init(root_ranges *self, const model *model, bool is_requested, int n_wheels, memory_arena *arena)
{
    *self = (root_ranges){.model = model, .n_wheels = is_requested ? n_wheels : 0};
    if (self->n_wheels == 0) {
        return;
    }
    self->most = model_root_teeth(model);
    self->values = arena_calloc(arena, (size_t)self->most * POINTS * STEP_NODES_MOST, sizeof *self->values);
    /* zeros: teeth far from all loads are not stressed */
    self->period = arena_calloc(arena, (size_t)count(self), sizeof *self->period);
    self->total = arena_calloc(arena, (size_t)count(self), sizeof *self->total);
}

void root_ranges_serialize(root_ranges *self, archive *archive)
{
    SERIALIZE_ARRAY(archive, self->period, count(self));
    SERIALIZE_ARRAY(archive, self->total, count(self));
}

/** Largest value in the part of the step, multiplied by the sense. The interpolation polynomial may overshoot where a
 *  tooth pair loses its force between the nodes; then the largest value at the nodes. */
static double highest(const step_nodes *nodes, const double *values, int sense)
{
    static const double most = 0.2; /* of the range at the nodes: excess of a smooth extreme between the nodes */
    double high = sense * values[0], low = high;
    for (int k = 1; k < nodes->n; k++) {
        high = fmax(high, sense * values[k]);
        low = fmin(low, sense * values[k]);
    }
    const double peak = step_nodes_peak(nodes, values, sense);
    return peak - high <= most * (high - low) ? peak : high;
}

void root_ranges_add(root_ranges *self, const step_nodes *nodes)
{
    for (int wheel = 0; wheel < self->n_wheels; wheel++) {
        const int n = model_sampler_root_points(nodes->sampler, wheel, self->most, nodes->n, self->values);
        double *period = self->period + (size_t)wheel * POINTS * 2;
        const double *total = self->total + (size_t)wheel * POINTS * 2;
        for (int i = 0; i < n * POINTS; i++) {
            const double *values = self->values + (size_t)i * (size_t)nodes->n;
            const node_range range = step_nodes_range(nodes, values);
            const int at = i % POINTS * 2;
            if (range.may_reach > fmax(period[at], total[at])) {
                period[at] = fmax(period[at], highest(nodes, values, 1));
            }
            if (range.may_fall < fmin(period[at + 1], total[at + 1])) {
                period[at + 1] = fmin(period[at + 1], -highest(nodes, values, -1));
            }
        }
    }
}

void root_ranges_complete(root_ranges *self)
{
    for (int i = 0; i < count(self); i += 2) {
        self->total[i] = fmax(self->total[i], self->period[i]);
        self->total[i + 1] = fmin(self->total[i + 1], self->period[i + 1]);
        self->period[i] = self->period[i + 1] = 0;
    }
}

/** Equation RS9. */
double root_ranges_of(const root_ranges *self, int wheel)
{
    if (wheel >= self->n_wheels) {
        return NAN;
    }
    const double *extremes = self->total + (size_t)wheel * POINTS * 2;
    double found = NAN;
    for (int side = 0; side < 2; side++) {
        double range[MODEL_ROOT_POINTS];
        int best = 0;
        for (int k = 0; k < MODEL_ROOT_POINTS; k++) {
            const double *one = extremes + 2 * (side * MODEL_ROOT_POINTS + k);
            range[k] = one[0] - one[1];
            best = range[k] > range[best] ? k : best;
        }
        double here = range[best];
        if (best > 0 && best < MODEL_ROOT_POINTS - 1) { /* vertex of the parabola through its neighbours */
            const double slope = 0.5 * (range[best + 1] - range[best - 1]);
            const double bend = range[best + 1] - 2 * range[best] + range[best - 1];
            here -= bend < 0 ? 0.5 * slope * slope / bend : 0;
        }
        found = fmax(found, here);
    }
    return found;
}
