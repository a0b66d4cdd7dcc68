/* A simulation whose outputs wait for each other gives those of one whose outputs do not, and says if they show a missed event. */
#include "base/interrupt.h"
#include "base/memory.h"
#include "simulate/case_start.h"
#include "simulate/simulate.h"

#include <setjmp.h>
#include <signal.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { MOST = 400 };

typedef struct {
    case_plan plan;
    dae_state start;
} fixture;

/* What a sink hears. */
typedef struct {
    memory_arena arena;
    requested_outputs requested;
    int n, n_values, n_blocks, n_events;
    double t[MOST], *values; /* [n_values * MOST] */
    double t_event;
    bool interrupts; /* after the first step */
} heard;

static bool on_outputs(void *self, const output_block *block)
{
    heard *h = self;
    h->n_blocks++;
    assert_true(h->n + block->n <= MOST);
    for (int k = 0; k < block->n; k++, h->n++) {
        assert_true(block->t[k] >= h->t_event); /* those before an event come before it */
        h->t[h->n] = block->t[k];
        for (int i = 0; i < h->n_values; i++) {
            h->values[h->n * h->n_values + i] = output_values(block, i)[k];
        }
    }
    return true;
}

static bool on_event(void *self, const event_record *record)
{
    heard *h = self;
    h->n_events++;
    h->t_event = record->t;
    assert_true(h->t[h->n - 1] <= record->t);
    return true;
}

static void on_step(void *self, double t)
{
    const heard *h = self;
    (void)t;
    if (h->interrupts) {
        interrupt_signal = SIGINT;
    }
}

/* All outputs. */
static void hear(const fixture *f, bool waits, heard *h, simulate_result *result)
{
    const model *model = f->plan.model;
    *h = (heard){.interrupts = h->interrupts};
    requested_outputs_init(&h->requested, model, &h->arena);
    for (int i = 0; i < model_about(model)->n_outputs; i++) {
        (void)requested_outputs_add(&h->requested, model_about(model)->outputs[i].name);
    }
    h->n_values = h->requested.n_values;
    h->values = arena_calloc(&h->arena, (size_t)h->n_values * MOST, sizeof *h->values);
    const simulate_sink sink = {.self = h,
                                .requested = &h->requested,
                                .waits = waits,
                                .outputs = on_outputs,
                                .event = on_event,
                                .step = on_step};
    simulate(&f->plan, &sink, &f->start, result);
}

static int set_up(void **state)
{
    static const char *const set[] = {"meshes.0.tracking=closed_form",
                                      "simulation={duration: 1.6, output_interval: 0.01, tolerance: 1e-5}"};
    fixture *f = xcalloc(1, sizeof *f);
    evl_error error;
    assert_true(case_plan_make(
        &f->plan, &(plan_request){.name = "examples/paper-friction.yaml", .n_set = 2, .set = set}, &error));
    assert_true(case_start(&f->plan, NULL, &f->start, NULL, &error));
    *state = f;
    return 0;
}

static int set_up_for_ida(void **state)
{
    static const char *const set[] = {
        "meshes.0.tracking=closed_form",
        "simulation={duration: 1.6, output_interval: 0.01, tolerance: 1e-5, integrator: ida}"};
    fixture *f = xcalloc(1, sizeof *f);
    evl_error error;
    assert_true(case_plan_make(
        &f->plan, &(plan_request){.name = "examples/paper-friction.yaml", .n_set = 2, .set = set}, &error));
    assert_true(case_start(&f->plan, NULL, &f->start, NULL, &error));
    *state = f;
    return 0;
}

static int tear_down(void **state)
{
    fixture *f = *state;
    case_plan_free(&f->plan);
    dae_state_free(&f->start);
    free(f);
    return 0;
}

/* To the bit: a history does not tell how its rows were found. */
static void outputs_that_wait_are_those_that_do_not(void **state)
{
    static heard alone, waiting;
    simulate_result result;
    hear(*state, false, &alone, &result);
    assert_int_equal(result.end, SIMULATE_DONE);
    assert_int_equal(alone.n_blocks, alone.n);
    hear(*state, true, &waiting, &result);
    assert_int_equal(result.end, SIMULATE_DONE);
    assert_int_equal(waiting.n, 161);
    assert_int_equal(waiting.n, alone.n);
    assert_int_equal(waiting.n_events, alone.n_events);
    assert_true(waiting.n_events > 0 && waiting.n_blocks < waiting.n / 4);
    assert_memory_equal(waiting.t, alone.t, (size_t)alone.n * sizeof(double));
    assert_memory_equal(waiting.values, alone.values, (size_t)(alone.n * alone.n_values) * sizeof(double));
    arena_free(&alone.arena);
    arena_free(&waiting.arena);
}

/* At the start the teeth press on each other; then they are a millimetre apart and count as pressed. */
static void part_the_teeth(fixture *f)
{
    CLEANUP_FREE model_state *states = model_states(f->plan.model);
    for (int i = 0; i < model_about(f->plan.model)->dae.n; i++) {
        f->start.y[i] += strncmp(states[i].name, "angle_deviation", 15) == 0 ? 1e-3 : 0.0;
    }
}

static void outputs_that_show_a_missed_event_are_wanted_one_by_one(void **state)
{
    static heard h;
    simulate_result result;
    part_the_teeth(*state);
    hear(*state, true, &h, &result);
    assert_int_equal(result.end, SIMULATE_MISSED);
    assert_int_equal(h.n, 0);
    arena_free(&h.arena);
    hear(*state, false, &h, &result);
    assert_int_equal(result.end, SIMULATE_FAILED);
    assert_non_null(strstr(result.message, "an event was missed"));
    arena_free(&h.arena);
}

/* Who interrupts does not wait for the simulation to be made again: it ends where its outputs can be trusted. */
static void an_interrupted_simulation_gives_what_it_has_gathered_if_no_event_was_missed(void **state)
{
    static heard h = {.interrupts = true};
    simulate_result result;
    hear(*state, true, &h, &result);
    interrupt_signal = 0;
    assert_int_equal(result.end, SIMULATE_INTERRUPTED);
    assert_true(h.n >= 2 && result.t > 0); /* the start and where it ended */
    assert_true(h.t[h.n - 1] == result.t);
    arena_free(&h.arena);
    part_the_teeth(*state);
    hear(*state, true, &h, &result);
    interrupt_signal = 0;
    assert_int_equal(result.end, SIMULATE_INTERRUPTED);
    assert_int_equal(h.n, 0);
    assert_true(result.t == 0);
    arena_free(&h.arena);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(outputs_that_wait_are_those_that_do_not, set_up, tear_down),
        cmocka_unit_test_setup_teardown(outputs_that_wait_are_those_that_do_not, set_up_for_ida, tear_down),
        cmocka_unit_test_setup_teardown(outputs_that_show_a_missed_event_are_wanted_one_by_one, set_up, tear_down),
        cmocka_unit_test_setup_teardown(an_interrupted_simulation_gives_what_it_has_gathered_if_no_event_was_missed,
                                        set_up, tear_down),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
