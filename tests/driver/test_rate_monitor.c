/* Integrals of reported rates are compared with the changes in a step: a state that changes otherwise ends the run. */
#include "base/memory.h"
#include "integrate/integrate.h"
#include "simulate/case_start.h"
#include "simulate/rate_monitor.h"
#include "simulate/simulate.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

/* The steps of a run in which one state drifts away from the motion, the same in every step. */
typedef struct {
    rate_monitor *monitor;
    int bent;     /* which state */
    double drift; /* by the end of a step */
    const integrate_step *step;
} drifting;

static double drift_at(const drifting *d, double t)
{
    return d->drift * (t - d->step->t_from) / (d->step->t_to - d->step->t_from);
}

static bool interpolate(const void *with, double t, double *y)
{
    const drifting *d = with;
    const bool good = d->step->interpolate(d->step->with, t, y);
    y[d->bent] += drift_at(d, t);
    return good;
}

static void interpolate_lanes(const void *with, const double *t, double *y)
{
    const drifting *d = with;
    d->step->interpolate_lanes(d->step->with, t, y);
    for (int k = 0; k < DAE_LANES; k++) {
        y[d->bent * DAE_LANES + k] += drift_at(d, t[k]);
    }
}

static void on_monitor(void *self, const integrate_step *step)
{
    drifting *d = self;
    integrate_step bent = *step;
    d->step = step;
    bent.with = d;
    bent.interpolate = interpolate;
    bent.interpolate_lanes = step->interpolate_lanes == NULL ? NULL : interpolate_lanes;
    rate_monitor_step(d->monitor, &bent);
}

static int on_output(void *self, const dae_state *state, const output_mark *mark, char *reason)
{
    (void)self, (void)state, (void)mark, (void)reason;
    return 0;
}

static int on_event(void *self, const event_record *event)
{
    (void)event;
    rate_monitor_event(((drifting *)self)->monitor);
    return 0;
}

static int on_step(void *self, double t)
{
    (void)self, (void)t;
    return 0;
}

typedef struct {
    char text[DAE_MESSAGE_LENGTH]; /* what is said of the run; "": nothing */
    int n;                         /* states */
    bool is_deviation;             /* whether the state is a deviation of an angle */
} judged;

/* A run from rest in which one state drifts by so many tolerances. */
static judged run(const char *example, const char *integrator, int bent, double tolerances)
{
    const char *set[] = {"simulation.initial={kind: rest}", "simulation.duration=5e-4", integrator};
    case_plan plan = {0};
    evl_error error;
    dae_state state;
    integrate_counts counts;
    char message[DAE_MESSAGE_LENGTH] = "";
    judged judged = {.text = ""};
    assert_true(
        case_plan_make(&plan, &(plan_request){.name = example, .n_set = sizeof set / sizeof *set, .set = set}, &error));
    assert_true(case_start(&plan, NULL, &state, NULL, &error));
    const dae *model = &model_about(plan.model)->dae;
    const integrate_options options = plan.integration;
    drifting d = {.monitor = rate_monitor_create(plan.model, options.tolerance), .bent = bent};
    d.drift = tolerances * options.tolerance * model->scale[bent];
    double *highest = xcalloc((size_t)model->n_monitored, sizeof *highest);
    for (int i = 0; i < model->n_monitored; i++) {
        highest[i] = INFINITY;
    }
    const integrate_observer observer = {
        .self = &d, .highest = highest, .output = on_output, .event = on_event, .step = on_step, .monitor = on_monitor};
    assert_int_equal(integrate(model, &options, &observer, &state, &counts, message), INTEGRATE_DONE);
    const char *said = rate_monitor_conclude(d.monitor);
    judged.n = model->n;
    model_state *states = model_states(plan.model);
    judged.is_deviation = strncmp(states[bent].name, "angle_deviation", strlen("angle_deviation")) == 0;
    free(states);
    free(highest);
    (void)snprintf(judged.text, sizeof judged.text, "%s", said == NULL ? "" : said);
    rate_monitor_delete(&d.monitor);
    dae_state_free(&state);
    case_plan_free(&plan);
    return judged;
}

/* Whether a run is stopped for a state that drifts, whichever that is, and not if none does. */
static void try_every_state(const char *example, const char *integrator, double tolerances, bool with_deviations)
{
    judged judged = run(example, integrator, 0, 0);
    assert_string_equal(judged.text, "");
    for (int i = 0; i < judged.n; i++) {
        judged = run(example, integrator, i, tolerances);
        if (with_deviations || !judged.is_deviation) {
            assert_non_null(strstr(judged.text, "but the integral of "));
        }
    }
}

static void test_a_drift_of_any_state_is_found_with_radau(void **state)
{
    (void)state;
    try_every_state("examples/spur-pair.yaml", "simulation.integrator=radau", 1e3, true);
    try_every_state("examples/motor-driven.yaml", "simulation.integrator=radau", 1e3, true);
}

/* Tolerances of a deviation are less than one of the angle of which it is a part. */
static void test_a_drift_of_any_state_but_deviations_is_found_with_ida(void **state)
{
    (void)state;
    try_every_state("examples/spur-pair.yaml", "simulation.integrator=ida", 1e4, false);
    try_every_state("examples/motor-driven.yaml", "simulation.integrator=ida", 1e4, false);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_a_drift_of_any_state_is_found_with_radau),
        cmocka_unit_test(test_a_drift_of_any_state_but_deviations_is_found_with_ida),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
