/* lanes_of_case CASE...: compares all outputs at eight states in lanes with those at each state, bit by bit, over the steps of each
 * case; reports which outputs had a value. */
#include "base/memory.h"
#include "integrate/integrate.h"
#include "simulate/case_start.h"
#include "simulate/simulate.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { EVERY = 7, MOST_LOOKS = 60, MOST_DIFFERENCES = 20 }; /* steps between comparisons; per case */

typedef struct {
    const char *file;
    const model *model;
    const model_facts *about;
    model_sampler *sampler;
    int n_requested, *requested;
    double *y, *one, *lanes; /* [states * DAE_LANES], [n_values], [n_values * DAE_LANES] */
    bool *has_value;         /* [n_outputs] had a value that is neither 0 nor none */
    long steps, looks, states;
    int differences;
} comparison;

static bool same(double a, double b)
{
    return (a == b && signbit(a) == signbit(b)) || (isnan(a) && isnan(b));
}

static void compare_state(comparison *c, double t, int lane)
{
    const double *at = c->lanes;
    for (int i = 0; i < c->n_requested; i++) {
        const model_output *output = &c->about->outputs[c->requested[i]];
        for (int k = 0; k < output->count; k++, at += DAE_LANES) {
            const double alone = c->one[output->offset + k];
            c->has_value[c->requested[i]] = c->has_value[c->requested[i]] || (isfinite(alone) && alone != 0);
            if (!same(alone, at[lane]) && c->differences++ < MOST_DIFFERENCES) {
                (void)printf("%s: t = %.17g: %s[%d] is %.17g alone, %.17g in lane %d\n", c->file, t, output->name, k,
                             alone, at[lane], lane);
            }
        }
    }
}

static void on_monitor(void *self, const integrate_step *step)
{
    comparison *c = self;
    if (!(step->t_to > step->t_from) || c->steps++ % EVERY != 0 || c->looks >= MOST_LOOKS) {
        return;
    }
    const int n = c->about->dae.n;
    char message[DAE_MESSAGE_LENGTH];
    double t[DAE_LANES];
    CLEANUP_FREE double *y = xcalloc((size_t)n, sizeof *y);
    for (int l = 0; l < DAE_LANES; l++) {
        t[l] = step->t_from + (step->t_to - step->t_from) * l / (DAE_LANES - 1.0);
        t[l] = fmin(t[l], step->t_to);
        if (!step->interpolate(step->with, t[l], y)) {
            return;
        }
        for (int i = 0; i < n; i++) {
            c->y[i * DAE_LANES + l] = y[i];
        }
    }
    if (model_sampler_lanes(c->sampler, DAE_LANES, false, t, c->y, step->state, c->lanes, message) != DAE_OK) {
        return;
    }
    c->looks++;
    for (int l = 0; l < DAE_LANES; l++) {
        dae_state state = *step->state;
        for (int i = 0; i < n; i++) {
            y[i] = c->y[i * DAE_LANES + l];
        }
        state.t = t[l];
        state.y = y;
        if (model_outputs(c->model, &state, c->one, message) != DAE_OK) {
            (void)printf("%s: t = %.17g: refused alone: %s\n", c->file, t[l], message);
            c->differences++;
            continue;
        }
        c->states++;
        compare_state(c, t[l], l);
    }
}

static int on_output(void *self, const dae_state *state, const output_mark *mark, char *reason)
{
    (void)self, (void)state, (void)mark, (void)reason;
    return 0;
}

static int on_event(void *self, const event_record *event)
{
    (void)self, (void)event;
    return 0;
}

/* Stop after enough comparisons. */
static int on_step(void *self, double t)
{
    (void)t;
    return ((const comparison *)self)->looks >= MOST_LOOKS;
}

static int compare(const char *file)
{
    comparison c = {.file = file};
    case_plan plan = {0};
    evl_error error;
    dae_state state;
    if (!case_plan_make(&plan, &(plan_request){.name = file}, &error)) {
        (void)printf("%s: refused\n", file);
        case_plan_free(&plan);
        return 0;
    }
    if (!case_start(&plan, NULL, &state, NULL, &error)) {
        (void)printf("%s: refused\n", file);
        case_plan_free(&plan);
        return 0;
    }
    c.model = plan.model;
    c.about = model_about(c.model);
    CLEANUP_FREE int *requested = xcalloc((size_t)c.about->n_outputs, sizeof *requested);
    CLEANUP_FREE double *y = xcalloc((size_t)c.about->dae.n * DAE_LANES, sizeof *y);
    CLEANUP_FREE double *one = xcalloc((size_t)c.about->n_values, sizeof *one);
    CLEANUP_FREE double *lanes = xcalloc((size_t)c.about->n_values * DAE_LANES, sizeof *lanes);
    CLEANUP_FREE bool *has_value = xcalloc((size_t)c.about->n_outputs, sizeof *has_value);
    for (int i = 0; i < c.about->n_outputs; i++) {
        if (!c.about->outputs[i].is_static && c.about->outputs[i].count > 0) {
            requested[c.n_requested++] = i;
        }
    }
    c.requested = requested, c.y = y, c.one = one, c.lanes = lanes, c.has_value = has_value;
    CLEANUP_FREE double *highest = xcalloc((size_t)c.about->dae.n_monitored, sizeof *highest);
    for (int i = 0; i < c.about->dae.n_monitored; i++) {
        highest[i] = INFINITY; /* extremes are not requested */
    }
    c.sampler = model_sampler_create(c.model, c.n_requested, c.requested);
    const integrate_options options = plan.integration;
    const integrate_observer observer = {
        .self = &c, .output = on_output, .event = on_event, .step = on_step, .monitor = on_monitor, .highest = highest};
    integrate_counts counts;
    char message[DAE_MESSAGE_LENGTH] = "";
    (void)integrate(&c.about->dae, &options, &observer, &state, &counts, message);
    (void)printf("%s: %ld states, %d differ; told:", file, c.states, c.differences);
    for (int i = 0; i < c.n_requested; i++) {
        if (c.has_value[c.requested[i]]) {
            (void)printf(" %s", c.about->outputs[c.requested[i]].name);
        }
    }
    (void)printf("\n%s: outputs:", file);
    for (int i = 0; i < c.n_requested; i++) {
        (void)printf(" %s", c.about->outputs[c.requested[i]].name);
    }
    (void)printf("\n");
    model_sampler_delete(&c.sampler);
    dae_state_free(&state);
    case_plan_free(&plan);
    return c.differences;
}

int main(int argc, char **argv)
{
    int differences = 0;
    for (int i = 1; i < argc; i++) {
        differences += compare(argv[i]);
    }
    return differences > 0;
}
