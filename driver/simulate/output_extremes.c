#include "simulate/output_extremes.h"

#include "base/peak.h"

#include <math.h>
#include <string.h>

void output_extremes_init(output_extremes *self, const model *model, int n_outputs, const sought_extreme *sought,
                          bool is_requested, step_nodes *nodes, memory_arena *arena)
{
    *self = (output_extremes){.model = model, .n_outputs = n_outputs};
    const model_facts *about = model_about(model);
    int requested[EXTREMES_MOST_OUTPUTS] = {0};
    for (int i = 0; i < n_outputs; i++) {
        const model_output *found = model_output_named(model, sought[i].output);
        if (!is_requested || found == NULL || found->count == 0) {
            return;
        }
        requested[i] = (int)(found - about->outputs);
    }
    for (int i = 0; i < n_outputs; i++) {
        self->sense[i] = sought[i].sense;
        self->first_at[i] = step_nodes_want(nodes, sought[i].output);
    }
    self->n = about->outputs[requested[0]].count;
    const size_t n_values = (size_t)n_outputs * (size_t)self->n;
    self->sampler = model_sampler_create(model, n_outputs, requested);
    self->y = arena_calloc(arena, (size_t)about->dae.n, sizeof *self->y);
    self->values = arena_calloc(arena, n_values, sizeof *self->values);
    self->period = arena_calloc(arena, n_values, sizeof *self->period);
    self->total = arena_calloc(arena, n_values, sizeof *self->total);
    for (size_t i = 0; i < n_values; i++) {
        self->period[i] = self->total[i] = -INFINITY;
    }
}

void output_extremes_clear(output_extremes *self)
{
    model_sampler_delete(&self->sampler);
}

void output_extremes_serialize(output_extremes *self, archive *archive)
{
    SERIALIZE_ARRAY(archive, self->period, self->n_outputs * self->n);
    SERIALIZE_ARRAY(archive, self->total, self->n_outputs * self->n);
}

typedef struct {
    output_extremes *self;
    const integrate_step *step;
    int at;    /**< index of the value at a state */
    int sense; /**< 1: largest, -1: least */
} view;

/** Raise an extreme. NaN does not count. */
static void raise_to(double value, double *extreme)
{
    *extreme = value > *extreme ? value : *extreme;
}

/** Value at a time in the step, multiplied by the sense; all extremes are updated. NaN if it is not available. */
static double value_at(void *with, double t)
{
    char message[DAE_MESSAGE_LENGTH];
    const view *view = with;
    output_extremes *self = view->self;
    if (!view->step->interpolate(view->step->with, t, self->y) ||
        model_sampler_ask(self->sampler, 1, &t, self->y, view->step->state, self->values, message) != DAE_OK) {
        return NAN;
    }
    for (int output = 0; output < self->n_outputs; output++) {
        for (int i = output * self->n; i < (output + 1) * self->n; i++) {
            raise_to(self->sense[output] * self->values[i], &self->period[i]);
        }
    }
    return view->sense * self->values[view->at];
}

/** Search an extreme near the largest value of both ends and the nodes. */
static void refine(const view *view, const step_nodes *nodes, const double *values, double from, double to)
{
    static const double first_width = 0.1; /* relative to the bracket */
    double t[STEP_NODES_MOST + 2], f[STEP_NODES_MOST + 2];
    const int last = nodes->n + 1;
    t[0] = from;
    t[last] = to;
    f[0] = value_at((void *)view, from);
    f[last] = value_at((void *)view, to);
    for (int k = 0; k < nodes->n; k++) {
        t[k + 1] = nodes->t[k];
        f[k + 1] = view->sense * values[k];
    }
    int best = 0;
    for (int k = 1; k <= last; k++) {
        best = f[k] > f[best] ? k : best;
    }
    const double left = t[best > 0 ? best - 1 : 0], right = t[best < last ? best + 1 : last];
    const double turn = best > 0 && best < last ? peak_of_parabola(t + best - 1, f + best - 1) : t[best];
    const peak_bracket bracket = {.left = left,
                                  .right = right,
                                  .start = isnan(turn) ? t[best] : fmin(fmax(turn, left), right),
                                  .width = first_width * (right - left),
                                  .expected = NAN,
                                  .threshold = f[best]};
    peak_climb(value_at, (void *)view, &bracket);
}

/** One element of an output in a part of a step. @param limit  that a new extreme must exceed, multiplied by the sense */
static void take(const view *view, const step_nodes *nodes, int index, double limit, double from, double to)
{
    static const double doubt =
        0.2; /* of the range at the nodes: how far a value may exceed the polynomial, at kinks */
    const double *values = step_nodes_value(nodes, index);
    const node_range range = step_nodes_range(nodes, values);
    if (!((view->sense > 0 ? range.may_reach : -range.may_fall) > limit)) {
        return;
    }
    const double margin = doubt * 0.5 * (range.may_reach - range.may_fall); /* the bounds are twice the range apart */
    if (step_nodes_peak(nodes, values, view->sense) + margin > limit) {
        refine(view, nodes, values, from, to);
    }
}

void output_extremes_add(output_extremes *self, const step_nodes *nodes, const integrate_step *step, double from,
                         double to)
{
    for (int i = 0; i < self->n_outputs * self->n; i++) {
        const int output = i / self->n;
        take(&(view){self, step, i, self->sense[output]}, nodes, self->first_at[output] + i % self->n,
             fmax(self->period[i], self->total[i]), from, to);
    }
}

void output_extremes_complete(output_extremes *self)
{
    for (int i = 0; i < self->n_outputs * self->n; i++) {
        raise_to(self->period[i], &self->total[i]);
        self->period[i] = -INFINITY;
    }
}

double output_extremes_of(const output_extremes *self, int output, int element)
{
    const double found = element < self->n ? self->total[output * self->n + element] : -INFINITY;
    return found > -INFINITY ? self->sense[output] * found : NAN;
}
