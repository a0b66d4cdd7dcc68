/* A run whose outputs are right keeps its invariants; one value that is wrong breaks the one that it belongs to. */
#include "base/memory.h"
#include "model/model_start.h"
#include "simulate/case_plan.h"
#include "simulate/invariant_monitor.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static const double tolerance = 1e-9;

typedef struct {
    case_plan plan;
    double *values; /* at the start, pressed a little */
    double *block;  /* the same at each time of a block */
    memory_arena arena;
    requested_outputs requested; /* all */
} fixture;

static double *output(const fixture *f, const char *name)
{
    const int offset = model_output_offset(f->plan.model, name);
    assert_true(offset >= 0);
    return f->values + offset;
}

static int set_up(void **state)
{
    const char *set[] = {"meshes.0.tracking=differential", "simulation.initial={kind: steady}"};
    fixture *f = xcalloc(1, sizeof *f);
    evl_error error;
    model_message refusal;
    model_start_orbit orbit;
    dae_state start;
    char message[DAE_MESSAGE_LENGTH];
    assert_true(
        case_plan_make(&f->plan, &(plan_request){.name = "examples/paper.yaml", .n_set = 2, .set = set}, &error));
    assert_int_equal(model_initial_state(f->plan.model, NULL, &start, &orbit, &refusal), MODEL_START_FOUND);
    f->values = xcalloc((size_t)model_about(f->plan.model)->n_values, sizeof *f->values);
    f->block = xcalloc((size_t)model_about(f->plan.model)->n_values * DAE_LANES, sizeof *f->block);
    assert_int_equal(model_outputs(f->plan.model, &start, f->values, message), DAE_OK);
    dae_state_free(&start);
    requested_outputs_init(&f->requested, f->plan.model, &f->arena);
    for (int i = 0; i < model_about(f->plan.model)->n_outputs;
         i++) { /* all, so that they stand as the model has them */
        (void)requested_outputs_add(&f->requested, model_about(f->plan.model)->outputs[i].name);
    }
    *state = f;
    return 0;
}

static int tear_down(void **state)
{
    fixture *f = *state;
    case_plan_free(&f->plan);
    arena_free(&f->arena);
    free(f->values);
    free(f->block);
    free(f);
    return 0;
}

static void look(invariant_monitor *monitor, const fixture *f, double t)
{
    for (int i = 0; i < model_about(f->plan.model)->n_values; i++) {
        for (int k = 0; k < DAE_LANES; k++) {
            f->block[i * DAE_LANES + k] = f->values[i];
        }
    }
    invariant_monitor_outputs(monitor, &(output_block){.n = 1, .t = &t, .values = f->block});
}

/* Outputs as they are, then with one value changed. */
static bool holds(fixture *f, const char *name, double change, char text[DAE_MESSAGE_LENGTH])
{
    invariant_monitor *monitor = invariant_monitor_create(&f->requested, 2, 1, tolerance);
    double *value = output(f, name);
    const double right = *value;
    look(monitor, f, 0);
    *value = right + change;
    look(monitor, f, 1e-3);
    *value = right;
    look(monitor, f, 1e-3); /* what was found stays */
    const bool held = invariant_monitor_report(monitor, text, DAE_MESSAGE_LENGTH);
    invariant_monitor_delete(&monitor);
    return held;
}

static void test_right_outputs_keep_the_invariants(void **state)
{
    char text[DAE_MESSAGE_LENGTH];
    assert_true(holds(*state, "kinetic_energy", 0, text));
    assert_string_equal(text, "held");
}

static void check(fixture *f, const char *name, double unit, double bound, const char *invariant)
{
    char text[DAE_MESSAGE_LENGTH], begin[64];
    assert_true(holds(f, name, 0.9 * bound * unit, text));
    assert_false(holds(f, name, 1.5 * bound * unit, text));
    (void)snprintf(begin, sizeof begin, "broken: %s 1.5", invariant);
    assert_memory_equal(text, begin, strlen(begin) - 1);
    assert_false(holds(f, name, NAN, text));
}

static void test_energy_that_appears_breaks_the_balance(void **state)
{
    const char *const energies[] = {"kinetic_energy", "potential_energy", "dissipated_energy", "load_work"};
    fixture *f = *state;
    /* what is there at the start, and the work of 1 N m on the pinion in 1 ms */
    const double unit = *output(f, "kinetic_energy") + *output(f, "potential_energy") +
                        1e-3 * fmax(output(f, "load_torque")[0] * output(f, "angular_velocity")[0], 0);
    for (size_t i = 0; i < sizeof energies / sizeof *energies; i++) {
        check(f, energies[i], unit, 10 * tolerance, "energy balance");
    }
}

static void test_points_off_their_places_are_found(void **state)
{
    fixture *f = *state;
    const double depth = fmax(*output(f, "penetration"), *output(f, "reference_penetration"));
    check(f, "tracking_residual_driven", depth, tolerance, "points on flanks");
    check(f, "line_distance_driving", depth, tolerance, "points on line of action");
    check(f, "gradient_ratio", 1.5, 1e-12, "gradient ratio");
}

/* In differential tracking the gap is a state of its own: points may keep to their flanks while it drifts. */
static void test_a_gap_that_drifts_from_the_positions_of_the_wheels_is_found(void **state)
{
    fixture *f = *state;
    const double depth = fmax(*output(f, "penetration"), *output(f, "reference_penetration"));
    const char *const lengths[] = {"gap", "transmission_error", "flank_deviation", "separation_curvature"};
    for (size_t i = 0; i < sizeof lengths / sizeof *lengths; i++) {
        check(f, lengths[i], depth, tolerance, "transmission error");
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_right_outputs_keep_the_invariants),
        cmocka_unit_test(test_energy_that_appears_breaks_the_balance),
        cmocka_unit_test(test_a_gap_that_drifts_from_the_positions_of_the_wheels_is_found),
        cmocka_unit_test(test_points_off_their_places_are_found),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
