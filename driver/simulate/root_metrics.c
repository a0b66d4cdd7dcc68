#include "simulate/root_metrics.h"

#include "base/peak.h"

#include <math.h>
#include <string.h>

static const char *const outputs[] = {"root_stress_max", "root_stress_min"};
static const root_extremes nothing = {-INFINITY, INFINITY};

void root_metrics_init(root_metrics *self, const model *model, bool is_requested, step_nodes *nodes,
                       memory_arena *arena)
{
    *self = (root_metrics){.model = model};
    const model_output *found[] = {model_output_named(model, outputs[0]), model_output_named(model, outputs[1])};
    if (!is_requested || found[0] == NULL || found[0]->count == 0) {
        return;
    }
    const model_facts *about = model_about(model);
    const int requested[] = {(int)(found[0] - about->outputs), (int)(found[1] - about->outputs)};
    self->n_wheels = found[0]->count;
    self->high_at = step_nodes_want(nodes, outputs[0]);
    self->low_at = step_nodes_want(nodes, outputs[1]);
    self->sampler = model_sampler_create(model, 2, requested);
    self->y = arena_calloc(arena, (size_t)about->dae.n, sizeof *self->y);
    self->values = arena_calloc(arena, 2 * (size_t)self->n_wheels, sizeof *self->values);
    self->period = arena_calloc(arena, (size_t)self->n_wheels, sizeof *self->period);
    self->total = arena_calloc(arena, (size_t)self->n_wheels, sizeof *self->total);
    for (int i = 0; i < self->n_wheels; i++) {
        self->period[i] = self->total[i] = nothing;
    }
}

void root_metrics_clear(root_metrics *self)
{
    model_sampler_delete(&self->sampler);
}

void root_metrics_serialize(root_metrics *self, archive *archive)
{
    SERIALIZE_ARRAY(archive, self->period, self->n_wheels);
    SERIALIZE_ARRAY(archive, self->total, self->n_wheels);
}

static void include(root_extremes *range, double high, double low)
{
    range->high = high > range->high ? high : range->high;
    range->low = low < range->low ? low : range->low;
}

typedef struct {
    root_metrics *self;
    const integrate_step *step;
    int at;    /**< index of the value at a state */
    int sense; /**< 1: largest, -1: least */
} view;

/** Value at a time in the step, multiplied by the sense; all extremes are updated. NaN if it is not available. */
static double value_at(void *with, double t)
{
    char message[DAE_MESSAGE_LENGTH];
    const view *view = with;
    root_metrics *self = view->self;
    if (!view->step->interpolate(view->step->with, t, self->y) ||
        model_sampler_ask(self->sampler, 1, &t, self->y, view->step->state, self->values, message) != DAE_OK) {
        return NAN;
    }
    for (int i = 0; i < self->n_wheels; i++) {
        include(&self->period[i], self->values[i], self->values[self->n_wheels + i]);
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

/** One output of a wheel in a part of a step. @param limit  that a new extreme must exceed, multiplied by the sense */
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

void root_metrics_add(root_metrics *self, const step_nodes *nodes, const integrate_step *step, double from, double to)
{
    for (int i = 0; i < self->n_wheels; i++) {
        const root_extremes *period = &self->period[i], *total = &self->total[i];
        take(&(view){self, step, i, 1}, nodes, self->high_at + i, fmax(period->high, total->high), from, to);
        take(&(view){self, step, self->n_wheels + i, -1}, nodes, self->low_at + i, -fmin(period->low, total->low), from,
             to);
    }
}

void root_metrics_complete(root_metrics *self)
{
    for (int i = 0; i < self->n_wheels; i++) {
        include(&self->total[i], self->period[i].high, self->period[i].low);
        self->period[i] = nothing;
    }
}

root_extremes root_metrics_of(const root_metrics *self, int wheel)
{
    const bool has_values = wheel < self->n_wheels && self->total[wheel].high >= self->total[wheel].low;
    return has_values ? self->total[wheel] : (root_extremes){NAN, NAN};
}
