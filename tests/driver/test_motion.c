/* A motion moved from outside: by steps it is a run to the bit, however long the steps; for an integrator of the caller's its rates,
 * indicators and events lead to the same; inputs act from where they change; what was kept goes on with the same bits. */
#include "base/memory.h"
#include "integrate/integrate.h"
#include "motion/motion.h"
#include "simulate/case_start.h"
#include "simulate/simulate.h"

#include <float.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { MOST = 3000, MOST_STATES = 40 };

static motion *make(const char *path, int n_set, const char *const *set)
{
    case_plan plan = {0};
    evl_error error = {.code = EVL_EXIT_OK};
    if (!case_plan_make(&plan, &(plan_request){.name = path, .n_set = n_set, .set = set}, &error)) {
        fail_msg("%s: %s", error.location, error.message);
    }
    motion *m = motion_create(&plan, &error);
    if (m == NULL) {
        fail_msg("%s: %s", error.location, error.message);
    }
    return m;
}

static void go(motion *m, double t)
{
    if (!motion_to(m, t)) {
        fail_msg("%s: %s", motion_error(m)->location, motion_error(m)->message);
    }
}

/* ---- a run ---- */

typedef struct {
    int n, n_outputs, n_events, n_again; /* of events: those that were found once more */
    double *y, t[MOST], t_event[MOST];
} heard;

static int on_output(void *self, const dae_state *state, const output_mark *mark, char reason[DAE_MESSAGE_LENGTH])
{
    heard *h = self;
    (void)mark, (void)reason;
    if (h->n_outputs < 0 || h->n_outputs >= MOST) {
        return 1;
    }
    h->t[h->n_outputs] = state->t;
    memcpy(h->y + (size_t)h->n * (size_t)h->n_outputs++, state->y, (size_t)h->n * sizeof *state->y);
    return 0;
}

static int on_event(void *self, const event_record *record)
{
    heard *h = self;
    if (h->n_events < 0 || h->n_events >= MOST) {
        return 1;
    }
    h->t_event[h->n_events++] = record->t;
    return 0;
}

static int on_step(void *self, double t)
{
    (void)self, (void)t;
    return 0;
}

static void run(const case_plan *plan, memory_arena *arena, heard *h)
{
    const dae *dae = &model_about(plan->model)->dae;
    const integrate_options options = plan->integration;
    const integrate_observer observer = {.self = h, .output = on_output, .event = on_event, .step = on_step};
    integrate_counts counts;
    char reason[DAE_MESSAGE_LENGTH];
    dae_state state;
    evl_error error;
    assert_true(case_start(plan, NULL, &state, NULL, &error));
    *h = (heard){.n = dae->n, .y = arena_calloc(arena, (size_t)dae->n * MOST, sizeof(double))};
    assert_int_equal(integrate(dae, &options, &observer, &state, &counts, reason), INTEGRATE_DONE);
    dae_state_free(&state);
}

/* ---- by steps ---- */

static const struct {
    const char *path, *set[3];
    double end, interval;
} cases[] = {
    {"examples/paper-friction.yaml",
     {"meshes.0.tracking=closed_form", "simulation.duration=0.4", "simulation.output_interval=0.01"},
     0.4,
     0.01},
    {"examples/spur-pair.yaml", {"simulation.duration=0.02", "simulation.output_interval=1e-4", "title=x"}, 0.02, 1e-4},
    {"examples/rattle.yaml", {"simulation.duration=0.1", "simulation.output_interval=1e-3", "title=x"}, 0.1, 1e-3},
    {"examples/two-stage.yaml", {"simulation.duration=0.01", "simulation.output_interval=1e-4", "title=x"}, 0.01, 1e-4},
};

static void by_steps_of_any_length_a_motion_is_the_run_to_the_bit(void **state)
{
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        ARENA_SCOPE memory_arena arena = {NULL};
        static heard h;
        motion *m = make(cases[i].path, 3, cases[i].set);
        run(motion_about(m)->plan, &arena, &h);
        assert_true(motion_start(m, true, cases[i].end));
        for (int k = 0; k < h.n_outputs; k++) {
            const double t = h.t[k];
            go(m, t - 0.3 * cases[i].interval);
            go(m, t - 0.299 * cases[i].interval);
            go(m, t);
            assert_memory_equal(motion_state(m)->y, h.y + (size_t)h.n * (size_t)k, (size_t)h.n * sizeof(double));
        }
        assert_true(h.n_events > 0);
        motion_delete(&m);
    }
}

static void what_was_kept_goes_on_with_the_same_bits(void **state)
{
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        archive kept = {0};
        motion *first = make(cases[i].path, 3, cases[i].set), *second = make(cases[i].path, 3, cases[i].set);
        const double mass[] = {7000};
        for (int k = 0; k < motion_about(first)->n_parameters; k++) {
            if (strcmp(motion_about(first)->parameters[k].of.path, "materials.steel.density") == 0) {
                motion_set_parameter(first, k, mass);
            }
        }
        assert_true(motion_start(first, true, DBL_MAX));
        go(first, 0.377 * cases[i].end);
        assert_true(motion_serialize(first, &kept));
        kept.is_reading = true;
        assert_true(motion_serialize(second, &kept));
        assert_true(archive_is_read(&kept));
        go(first, cases[i].end);
        go(second, cases[i].end);
        assert_memory_equal(motion_state(first)->y, motion_state(second)->y,
                            (size_t)motion_about(first)->n_states * sizeof(double));
        archive_free(&kept);
        motion_delete(&first);
        motion_delete(&second);
    }
}

/* ---- states, rates and events ---- */

/* The classical method of order 4, from where the motion is, by h. */
static void rk4(motion *m, double h)
{
    static const double at[] = {0, 0.5, 0.5, 1}, weight[] = {1.0 / 6, 1.0 / 3, 1.0 / 3, 1.0 / 6};
    const int n = motion_about(m)->n_states;
    const double t = motion_state(m)->t;
    double y[MOST_STATES], sum[MOST_STATES], trial[MOST_STATES];
    assert_true(n <= MOST_STATES);
    memcpy(y, motion_state(m)->y, (size_t)n * sizeof *y);
    memcpy(sum, y, sizeof sum);
    memcpy(trial, y, sizeof trial);
    for (int stage = 0; stage < 4; stage++) {
        dae_code code;
        const double *rates = motion_rates(m, &code);
        assert_non_null(rates);
        for (int i = 0; i < n; i++) {
            sum[i] += weight[stage] * h * rates[i];
            trial[i] = stage < 3 ? y[i] + at[stage + 1] * h * rates[i] : sum[i];
        }
        motion_set_state(m, t + (stage < 3 ? at[stage + 1] : 1.0) * h, trial);
    }
}

/* Event indicators after an event: those that are live are off zero, the others are 1. */
static void check_indicators(motion *m)
{
    const motion_facts *about = motion_about(m);
    const dae *dae = &model_about(about->plan->model)->dae;
    int directions[400];
    dae_code code;
    const double *z = motion_indicators(m, &code);
    assert_non_null(z);
    assert_true(about->n_indicators <= 400);
    dae->root_directions(dae->self, motion_state(m)->integers, directions);
    for (int i = 0; i < about->n_indicators; i++) {
        if (directions[i] == 0) {
            assert_true(z[i] <= 1 && z[i] >= 1);
        } else { /* the program keeps 1e-10 between a change of mode and the next; rounding takes a little of it */
            assert_true(-directions[i] * z[i] > 0.9e-10);
        }
    }
}

/* Integrate one step at a time; where an event is due, find it by halving, to the last bits of the time. */
static int integrate_from_outside(motion *m, double end, double h, double *t_event)
{
    const int n = motion_about(m)->n_states;
    double y[MOST_STATES];
    int n_events = 0;
    while (motion_state(m)->t < end) {
        const double t = motion_state(m)->t;
        memcpy(y, motion_state(m)->y, (size_t)n * sizeof *y);
        rk4(m, fmin(h, end - t));
        if (!motion_is_due(m)) {
            continue;
        }
        double before = 0, after = h;
        while (after - before > 4e-16 * (t + h)) {
            const double middle = 0.5 * (before + after);
            motion_set_state(m, t, y);
            rk4(m, middle);
            *(motion_is_due(m) ? &after : &before) = middle;
        }
        motion_set_state(m, t, y);
        rk4(m, after);
        motion_change change = {.again = true};
        while (change.again) {
            assert_true(motion_update(m, &change));
        }
        check_indicators(m);
        assert_true(n_events < MOST);
        t_event[n_events++] = motion_state(m)->t;
    }
    return n_events;
}

/* Of a pair in steady mesh: the program's events and those that another integrator comes to. */
static void another_integrator_finds_the_same_motion_and_its_events(void **state)
{
    (void)state;
    static const char *const set[] = {"simulation.duration=0.004", "simulation.output_interval=1e-3",
                                      "simulation.tolerance=1e-12"};
    ARENA_SCOPE memory_arena arena = {NULL};
    static heard h;
    static double t_event[MOST];
    motion *m = make("examples/spur-pair.yaml", 3, set);
    run(motion_about(m)->plan, &arena, &h);
    assert_true(motion_start(m, false, DBL_MAX));
    const int n = integrate_from_outside(m, 0.004, 1e-6, t_event);
    assert_true(n > 5);
    int k = 0;
    for (int i = 0; i < h.n_events; i++) { /* several things may happen at one */
        if (i > 0 && h.t_event[i] <= h.t_event[i - 1]) {
            continue;
        }
        assert_true(k < n);
        assert_true(fabs(t_event[k] - h.t_event[i]) < 1e-10); /* what an importer may be asked for */
        k++;
    }
    assert_int_equal(k, n);
    const double *y = h.y + (size_t)h.n * (size_t)(h.n_outputs - 1), *scales = motion_scales(m);
    for (int i = 0; i < h.n; i++) { /* a step of 1e-6 s of order 4 in a vibration of some kHz */
        assert_true(fabs(motion_state(m)->y[i] - y[i]) < 1e-6 * scales[i] + 1e-8 * fabs(y[i]));
    }
    motion_delete(&m);
}

/* ---- inputs ---- */

static const char pair_of_discs[] =
    "format: 1\n"
    "materials: {steel: {youngs_modulus: 2.0e+11, poisson_ratio: 0.3, density: 7800}}\n"
    "wheels:\n"
    "- {name: a, teeth: 20, module: 3 mm, width: 0.02, material: steel, centre: [0, 0], loads: [{kind: %s, value: "
    "%s}]}\n"
    "- {name: b, teeth: 30, module: 3 mm, width: 0.02, material: steel, loads: [{kind: torque, value: 6}]}\n"
    "meshes:\n"
    "- {name: m, driving: a, driven: b, driving_rotation: counterclockwise, centre_line_angle: 0, backlash: 0.1 mm,\n"
    "   contact: {law: johnson}, damping: {law: linear, coefficient: 1e3}, friction: {law: none}, tracking: "
    "closed_form}\n"
    "simulation: {duration: 0.1, output_interval: 1e-3, initial: {kind: %s}}\n";

static motion *make_pair(const char *kind, const char *value)
{
    evl_error error = {.code = EVL_EXIT_OK};
    CLEANUP_FREE char *text = xasprintf(pair_of_discs, kind, value, strcmp(kind, "speed") == 0 ? "steady" : "rest");
    motion *m = motion_read("pair.yaml", text, &error);
    if (m == NULL) {
        fail_msg("%s: %s", error.location, error.message);
    }
    return m;
}

/* Forces of a mesh are the same on both wheels, along one line: J_a omega_a - (z_a/z_b) J_b omega_b grows by the torques alone,
 * whatever happens in the mesh. */
static void torques_that_change_are_what_the_wheels_get(void **state)
{
    (void)state;
    motion *m = make_pair("torque", "5");
    const motion_facts *about = motion_about(m);
    const model *model = about->plan->model;
    CLEANUP_FREE double *constants = xcalloc((size_t)model_about(model)->n_values, sizeof *constants);
    model_constants(model, constants);
    const double *inertia = constants + model_output_offset(model, "inertia"), ratio = 20.0 / 30.0;
    double given = 0;
    assert_int_equal(about->n_inputs, 2);
    assert_string_equal(about->inputs[1].of.path, "wheels.b.loads.0.value");
    assert_true(motion_start(m, true, DBL_MAX));
    const double h = 1e-4;
    for (int k = 0; k < 300; k++) {
        const double torque_a = k < 50 ? 5 : 5 + 4 * sin(0.1 * k), torque_b = k % 100 < 20 ? 6 : 4;
        if (k >= 50) {
            motion_set_input(m, 0, false, torque_a);
        }
        motion_set_input(m, 1, false, torque_b);
        go(m, (k + 1) * h);
        given += h * (torque_a - ratio * torque_b);
    }
    const double found = inertia[0] * model_wheel_speed(model, 0, motion_state(m)) -
                         ratio * inertia[1] * model_wheel_speed(model, 1, motion_state(m));
    assert_true(fabs(found - given) < 1e-9 * fabs(given)); /* the tolerance of the integrator over 300 steps */
    motion_delete(&m);
}

static void a_speed_is_followed_by_its_wheel(void **state)
{
    (void)state;
    motion *m = make_pair("speed", "50");
    const double h = 1e-4, f = 200;
    motion_set_input(m, 0, true, 10 * f);
    assert_true(motion_start(m, true, DBL_MAX));
    for (int k = 0; k < 200; k++) {
        const double t = k * h;
        motion_set_input(m, 0, false, 50 + 10 * sin(f * t));
        motion_set_input(m, 0, true, 10 * f * cos(f * t));
        go(m, (k + 1) * h);
        const double turns = model_wheel_speed(motion_about(m)->plan->model, 0, motion_state(m));
        /* a step goes along the tangent: half the second derivative times h^2 */
        assert_true(fabs(turns - (50 + 10 * sin(f * (t + h)))) < 0.51 * 10 * f * f * h * h);
    }
    motion_delete(&m);
}

static void a_speed_that_jumps_is_refused(void **state)
{
    (void)state;
    motion *m = make_pair("speed", "50");
    assert_true(motion_start(m, true, DBL_MAX));
    go(m, 1e-3);
    motion_set_input(m, 0, false, 50.1);
    assert_false(motion_to(m, 2e-3));
    assert_non_null(strstr(motion_error(m)->message,
                           "the speed given for wheel 'a' jumps: it is 50.1 rad/s, and the wheel turns at 50 rad/s"));
    motion_set_input(m, 0, false, 50);
    go(m, 2e-3);
    assert_true(motion_start(m, false, DBL_MAX));
    assert_true(motion_check_speeds(m));
    motion_set_input(m, 0, false, 50.1);
    assert_false(motion_check_speeds(m));
    motion_delete(&m);
}

static void an_input_that_does_not_change_changes_nothing(void **state)
{
    (void)state;
    motion *once = make_pair("speed", "50"), *often = make_pair("speed", "50");
    assert_true(motion_start(once, true, DBL_MAX) && motion_start(often, true, DBL_MAX));
    for (int k = 1; k <= 100; k++) {
        go(often, k * 1e-4);
    }
    go(once, 1e-2);
    assert_memory_equal(motion_state(once)->y, motion_state(often)->y,
                        (size_t)motion_about(once)->n_states * sizeof(double));
    motion_delete(&once);
    motion_delete(&often);
}

static void parameters_are_those_of_a_case_that_says_them(void **state)
{
    (void)state;
    static const char *const set[] = {"materials.steel.density=7000"};
    motion *edited = make("examples/spur-pair.yaml", 1, set), *given = make("examples/spur-pair.yaml", 0, NULL);
    const motion_facts *about = motion_about(given);
    const size_t size = (size_t)about->n_states * sizeof(double);
    const double density[] = {7000}, teeth[] = {31.5};
    int n_teeth = -1;
    assert_true(motion_start(edited, true, DBL_MAX));
    go(edited, 1e-3);
    for (int k = 0; k < about->n_parameters; k++) {
        n_teeth = strcmp(about->parameters[k].of.path, "wheels.gear.teeth") == 0 ? k : n_teeth;
        if (strcmp(about->parameters[k].of.path, "materials.steel.density") == 0) {
            motion_set_parameter(given, k, density);
        }
    }
    assert_true(motion_start(given, true, DBL_MAX));
    go(given, 1e-3);
    assert_memory_equal(motion_state(edited)->y, motion_state(given)->y, size);
    assert_true(n_teeth >= 0);
    motion_set_parameter(given, n_teeth, teeth);
    assert_false(motion_start(given, true, DBL_MAX));
    assert_non_null(strstr(motion_error(given)->location, "wheels.gear.teeth"));
    assert_true(motion_reset(given) && motion_start(given, true, DBL_MAX));
    go(given, 1e-3);
    assert_memory_not_equal(motion_state(edited)->y, motion_state(given)->y, size);
    motion_delete(&edited);
    motion_delete(&given);
}

static void what_radau_does_not_serve_is_refused(void **state)
{
    (void)state;
    case_plan plan = {0};
    evl_error error = {.code = EVL_EXIT_OK};
    assert_true(case_plan_make(&plan, &(plan_request){.name = "examples/paper.yaml"}, &error));
    assert_null(motion_create(&plan, &error));
    assert_int_equal(error.code, EVL_EXIT_CASE);
    assert_non_null(strstr(error.message, "tracked contact points"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(by_steps_of_any_length_a_motion_is_the_run_to_the_bit),
        cmocka_unit_test(what_was_kept_goes_on_with_the_same_bits),
        cmocka_unit_test(another_integrator_finds_the_same_motion_and_its_events),
        cmocka_unit_test(torques_that_change_are_what_the_wheels_get),
        cmocka_unit_test(a_speed_is_followed_by_its_wheel),
        cmocka_unit_test(a_speed_that_jumps_is_refused),
        cmocka_unit_test(an_input_that_does_not_change_changes_nothing),
        cmocka_unit_test(parameters_are_those_of_a_case_that_says_them),
        cmocka_unit_test(what_radau_does_not_serve_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
