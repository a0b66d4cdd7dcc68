/* One-sided damping has a kink where the flanks stop approaching: steps end there, and none goes over it. */
#include "base/memory.h"
#include "integrate/integrate.h"
#include "simulate/case_start.h"
#include "simulate/simulate.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

typedef struct {
    case_plan plan;
    double *values, *y;
    double standstill;        /* rates nearer to zero than this [m/s] are none */
    int n_pressed, n_astride; /* steps with flanks that press; those of them over a kink */
    double sense;             /* of the rate at the last one; 0 at first */
    int n_kinks;              /* between steps */
} ringing;

static double output(const ringing *r, const char *name)
{
    const int offset = model_output_offset(r->plan.model, name);
    assert_true(offset >= 0);
    return r->values[offset];
}

/* Outputs of the discrete state of the step. */
static void look(ringing *r, const integrate_step *step, double t)
{
    char message[DAE_MESSAGE_LENGTH];
    assert_true(step->interpolate(step->with, t, r->y));
    dae_state state = *step->state;
    state.t = t;
    state.y = r->y;
    assert_int_equal(model_outputs(r->plan.model, &state, r->values, message), DAE_OK);
}

/* -1, 1; 0 near standstill */
static double sense_of_rate(const ringing *r)
{
    const double rate = output(r, "gap_rate");
    return fabs(rate) <= r->standstill ? 0 : copysign(1, rate);
}

static void on_monitor(void *self, const integrate_step *step)
{
    ringing *r = self;
    if (!(step->t_to > step->t_from)) {
        return;
    }
    look(r, step, step->t_from);
    const double first = sense_of_rate(r);
    look(r, step, step->t_to);
    const double last = sense_of_rate(r);
    if (output(r, "contact_mode") != 1) {
        r->sense = 0;
        return;
    }
    r->n_pressed++;
    r->n_astride += first * last < 0;
    const double sense = last == 0 ? first : last;
    r->n_kinks += r->sense * sense < 0;
    r->sense = sense == 0 ? r->sense : sense;
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

static int on_step(void *self, double t)
{
    (void)self, (void)t;
    return 0;
}

/* Gears that ring at 8 kHz, from rest under load, with steps up to a quarter of a period. */
static void run(const char *integrator)
{
    const char *set[] = {"meshes.0.damping={law: one_sided, coefficient: 2e8}",
                         "meshes.0.friction={law: none}",
                         "simulation.initial={kind: rest}",
                         "simulation.duration=2e-3",
                         "simulation.tolerance=1e-6",
                         integrator};
    ringing r = {0};
    evl_error error;
    dae_state state;
    integrate_counts counts;
    char message[DAE_MESSAGE_LENGTH] = "";
    assert_true(case_plan_make(
        &r.plan, &(plan_request){.name = "examples/spur-pair.yaml", .n_set = sizeof set / sizeof *set, .set = set},
        &error));
    assert_true(case_start(&r.plan, NULL, &state, NULL, &error));
    const dae *model = &model_about(r.plan.model)->dae;
    r.values = xcalloc((size_t)model_about(r.plan.model)->n_values, sizeof *r.values);
    r.y = xcalloc((size_t)model->n, sizeof *r.y);
    assert_int_equal(model_outputs(r.plan.model, &state, r.values, message), DAE_OK);
    /* a root lies 1e-6 of this rate past the kink (src/mesh_roots.f90), and is located to a hundredth of that */
    r.standstill =
        2e-6 * sqrt(output(&r, "reference_force") * output(&r, "reference_penetration") / output(&r, "reference_mass"));
    assert_true(r.standstill > 0);
    const integrate_options options = r.plan.integration;
    const integrate_observer observer = {
        .self = &r, .output = on_output, .event = on_event, .step = on_step, .monitor = on_monitor};
    assert_int_equal(integrate(model, &options, &observer, &state, &counts, message), INTEGRATE_DONE);
    assert_in_range(r.n_kinks, 20, r.n_pressed / 2); /* two a period of the ringing, and it was seen */
    assert_int_equal(r.n_astride, 0);
    dae_state_free(&state);
    case_plan_free(&r.plan);
    free(r.values);
    free(r.y);
}

static void test_no_step_of_radau_goes_over_the_kink(void **state)
{
    (void)state;
    run("simulation.integrator=radau");
}

static void test_no_step_of_ida_goes_over_the_kink(void **state)
{
    (void)state;
    run("simulation.integrator=ida");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_no_step_of_radau_goes_over_the_kink),
        cmocka_unit_test(test_no_step_of_ida_goes_over_the_kink),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
