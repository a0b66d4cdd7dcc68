/* Two cases at once, in two threads or in turns, give the bits that each gives alone. No history is written: that is a
 * matter of HDF5, which has its own locks. */
#include "base/memory.h"
#include "integrate/integrate.h"
#include "model/model_start.h"
#include "simulate/case_plan.h"

#include <pthread.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

/* All that a run tells: outputs, events with the states on both sides, counts. */
typedef struct {
    size_t n, capacity;
    double *values;
} tape;

typedef struct case_run case_run;
struct case_run {
    const char *path, *set[4];
    int n_set;
    case_plan plan;
    dae_state state;
    double *values;
    tape tape;
    integrate_code code;
    integrate_counts counts;
    char reason[DAE_MESSAGE_LENGTH];
    case_run *meanwhile; /* run from within the outputs of this one, and forgotten */
};

static void put(tape *tape, const double *values, int n)
{
    const size_t more = (size_t)n;
    if (tape->n + more > tape->capacity) {
        tape->capacity = 2 * (tape->capacity + more);
        tape->values = xrealloc(tape->values, tape->capacity, sizeof *tape->values);
    }
    memcpy(tape->values + tape->n, values, more * sizeof *values);
    tape->n += more;
}

static void integrate_alone(case_run *run);
static void forget(case_run *run);

static int on_output(void *self, const dae_state *state, const output_mark *mark, char *reason)
{
    (void)mark;
    case_run *run = self;
    const int code = model_outputs(run->plan.model, state, run->values, reason);
    if (code != DAE_OK) {
        return code == DAE_RECOVERABLE ? INTEGRATE_ANEW : 1;
    }
    put(&run->tape, &state->t, 1);
    put(&run->tape, run->values, model_about(run->plan.model)->n_values);
    if (run->meanwhile != NULL) {
        integrate_alone(run->meanwhile);
        forget(run->meanwhile);
    }
    return 0;
}

static int on_event(void *self, const event_record *record)
{
    case_run *run = self;
    const double what[] = {record->t, record->what.kind, record->what.subject, record->what.count};
    put(&run->tape, what, 4);
    put(&run->tape, record->before->y, record->n);
    put(&run->tape, record->after->y, record->n);
    return 0;
}

static int on_step(void *self, double t)
{
    (void)self, (void)t;
    return 0;
}

/* The whole way from the file to the end of the integration. Asserts nothing: cmocka's checks belong to one thread. */
static void integrate_alone(case_run *run)
{
    evl_error error;
    model_message refusal;
    model_start_orbit orbit;
    run->code = INTEGRATE_FAILED;
    if (!case_plan_make(&run->plan, &(plan_request){.name = run->path, .n_set = run->n_set, .set = run->set}, &error)) {
        (void)snprintf(run->reason, sizeof run->reason, "%.*s", (int)sizeof run->reason - 1, error.message);
        return;
    }
    run->values = xcalloc((size_t)model_about(run->plan.model)->n_values, sizeof *run->values);
    if (model_initial_state(run->plan.model, NULL, &run->state, &orbit, &refusal) != MODEL_START_FOUND) {
        (void)snprintf(run->reason, sizeof run->reason, "%s", refusal.message);
        return;
    }
    const simulation_description *simulation = &run->plan.description->simulation;
    const integrate_options options = {.t_end = simulation->duration,
                                       .output_interval = simulation->output_interval,
                                       .tolerance = simulation->tolerance,
                                       .max_step = simulation->max_step,
                                       .by_stepper = simulation->integrator == INTEGRATOR_RADAU};
    const integrate_observer observer = {.self = run, .output = on_output, .event = on_event, .step = on_step};
    run->code =
        integrate(&model_about(run->plan.model)->dae, &options, &observer, &run->state, &run->counts, run->reason);
    const double ends[] = {(double)run->counts.steps, (double)run->counts.residuals, run->state.t};
    put(&run->tape, ends, 3);
    put(&run->tape, run->state.y, model_about(run->plan.model)->dae.n);
}

static void forget(case_run *run)
{
    dae_state_free(&run->state);
    free(run->values);
    free(run->tape.values);
    case_plan_free(&run->plan);
    run->state = (dae_state){0};
    run->values = NULL;
    run->tape = (tape){0};
}

static case_run first(void)
{
    return (case_run){.path = "examples/paper-friction.yaml", .set = {"simulation.duration=1.5"}, .n_set = 1};
}

static case_run second(void)
{
    return (case_run){.path = "examples/pair-23-41.yaml",
                      .set = {"simulation.duration=0.4", "meshes.0.tracking=algebraic"},
                      .n_set = 2};
}

/* By radau, with pairs that enter and leave. */
static case_run third(void)
{
    return (case_run){.path = "examples/spur-pair.yaml", .set = {"simulation.duration=0.1"}, .n_set = 1};
}

static void assert_same(const case_run *one, const case_run *other)
{
    assert_string_equal(one->reason, "");
    assert_int_equal(one->code, INTEGRATE_DONE);
    assert_int_equal(other->code, INTEGRATE_DONE);
    assert_true(one->counts.events > 0); /* else little is compared */
    assert_int_equal(one->tape.n, other->tape.n);
    assert_memory_equal(one->tape.values, other->tape.values, one->tape.n * sizeof(double));
}

static void *in_thread(void *self)
{
    integrate_alone(self);
    return NULL;
}

static void a_case_gives_the_same_bits_twice(void **state)
{
    (void)state;
    case_run pairs[][2] = {{first(), first()}, {third(), third()}};
    for (int i = 0; i < 2; i++) {
        integrate_alone(&pairs[i][0]);
        integrate_alone(&pairs[i][1]);
        assert_same(&pairs[i][0], &pairs[i][1]);
        forget(&pairs[i][0]);
        forget(&pairs[i][1]);
    }
}

static void two_cases_in_two_threads_give_the_bits_of_single_runs(void **state)
{
    (void)state;
    case_run alone[] = {first(), second(), third()};
    for (int i = 0; i < 3; i++) {
        integrate_alone(&alone[i]);
    }
    for (int turn = 0; turn < 2; turn++) {
        /* every case twice */
        case_run together[] = {first(), second(), third(), first(), second(), third()};
        pthread_t threads[6];
        for (int i = 0; i < 6; i++) {
            assert_int_equal(pthread_create(&threads[i], NULL, in_thread, &together[i]), 0);
        }
        for (int i = 0; i < 6; i++) {
            assert_int_equal(pthread_join(threads[i], NULL), 0);
        }
        for (int i = 0; i < 6; i++) {
            assert_same(&alone[i % 3], &together[i]);
            forget(&together[i]);
        }
    }
    for (int i = 0; i < 3; i++) {
        forget(&alone[i]);
    }
}

static void a_case_within_the_outputs_of_another_changes_neither(void **state)
{
    (void)state;
    case_run (*const cases[])(void) = {first, third};
    for (int i = 0; i < 2; i++) {
        case_run alone = cases[i](), outer = cases[i](), inner = cases[1 - i]();
        inner.set[0] = "simulation.duration=1e-2";
        outer.set[1] = alone.set[1] = i == 0 ? "simulation.output_interval=0.1" : "simulation.output_interval=0.01";
        outer.n_set = alone.n_set = 2;
        outer.meanwhile = &inner;
        integrate_alone(&alone);
        integrate_alone(&outer);
        assert_same(&alone, &outer);
        assert_int_equal(inner.code, INTEGRATE_DONE);
        forget(&alone);
        forget(&outer);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_case_gives_the_same_bits_twice),
        cmocka_unit_test(two_cases_in_two_threads_give_the_bits_of_single_runs),
        cmocka_unit_test(a_case_within_the_outputs_of_another_changes_neither),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
