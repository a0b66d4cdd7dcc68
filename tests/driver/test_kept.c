/* A simulation that is kept between two steps and goes on in other memory gives the bits of one that was not: outputs, events, extremes,
 * numbers, counts, invariants. With IDA both are kept at the same times. */
#include "base/archive.h"
#include "base/memory.h"
#include "simulate/case_start.h"
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

/* With sanitizers each run takes ten times as long; the build without them resumes at all five. */
#ifdef __SANITIZE_ADDRESS__
enum { MAX_CHECKPOINTS = 2, MOST_SETS = 4 };
#else
enum { MAX_CHECKPOINTS = 5, MOST_SETS = 4 };
#endif

/* What was kept, and how much had been told by then. */
typedef struct {
    unsigned char *bytes;
    size_t n, recorded;
} keepsake;

typedef struct {
    memory_arena arena;
    requested_outputs requested;
    extremes *extremes;
    metrics *metrics;
    archive recorded;         /**< all that was told, one after the other */
    long every, rests, n_due; /**< every so many rests it is due, up to MAX_CHECKPOINTS times */
    int n_checkpoints;
    keepsake checkpoints[MAX_CHECKPOINTS];
} listener;

static void append(listener *l, const void *bytes, size_t n)
{
    memcpy(archive_take(&l->recorded, n), bytes, n);
}

static bool on_outputs(void *self, const output_block *block)
{
    listener *l = self;
    for (int k = 0; k < block->n; k++) {
        append(l, &block->t[k], sizeof(double));
        for (int i = 0; i < l->requested.n_values; i++) {
            append(l, &output_values(block, i)[k], sizeof(double));
        }
        if (block->marks != NULL) {
            append(l, &block->marks[k].position, sizeof(double));
            append(l, &block->marks[k].kind, sizeof block->marks[k].kind);
        }
    }
    return true;
}

static bool on_event(void *self, const event_record *record)
{
    listener *l = self;
    append(l, &record->t, sizeof record->t);
    append(l, &record->what, sizeof record->what);
    append(l, record->before->y, (size_t)record->n * sizeof(double));
    append(l, record->after->y, (size_t)record->n * sizeof(double));
    return true;
}

static bool is_due(void *self, double t)
{
    listener *l = self;
    (void)t;
    return ++l->rests % l->every == 0 && l->n_due < MAX_CHECKPOINTS;
}

static void serialize(void *self, archive *archive)
{
    listener *l = self;
    l->n_due += !archive->is_reading;
    SERIALIZE(archive, l->rests);
    SERIALIZE(archive, l->n_due);
}

static simulate_checkpoint_outcome on_checkpoint(void *self, double t, const archive *archive)
{
    listener *l = self;
    (void)t;
    keepsake *one = &l->checkpoints[l->n_checkpoints++];
    *one = (keepsake){arena_calloc(&l->arena, archive->n, 1), archive->n, l->recorded.n};
    memcpy(one->bytes, archive->bytes, archive->n);
    return SIMULATE_GOES_ON;
}

static void append_end(listener *l, const case_plan *plan, simulate_result *result)
{
    const model *model = plan->model;
    ARENA_SCOPE memory_arena arena = {NULL};
    model_output rows[N_METRIC_ROWS];
    const int n = metric_rows_lay_out(&model_about(model)->names, rows);
    double *values = arena_calloc(&arena, (size_t)n, sizeof *values);
    for (int k = 0; k < model_tables()->n_extremes; k++) {
        for (int mesh = 0; mesh < plan->description->n_meshes; mesh++) {
            const extreme_found found = extremes_found(l->extremes, k, mesh);
            append(l, &found, sizeof found);
        }
    }
    if (l->metrics != NULL) {
        metrics_conclude(l->metrics, values);
        append(l, values, (size_t)n * sizeof *values);
    }
    result->counts.cpu_seconds = 0;
    append(l, &result->counts, sizeof result->counts);
    append(l, &result->t, sizeof result->t);
    append(l, &result->energy_residual, sizeof result->energy_residual);
    append(l, result->remark, strlen(result->remark));
    append(l, result->invariants, strlen(result->invariants));
}

static void want_all(requested_outputs *requested, const model *model, memory_arena *arena)
{
    const model_facts *about = model_about(model);
    requested_outputs_init(requested, model, arena);
    for (int i = 0; i < about->n_outputs; i++) {
        if (!about->outputs[i].is_static) {
            (void)requested_outputs_add(requested, about->outputs[i].name);
        }
    }
}

/* From the start, or from what was kept; it is kept every so many rests, or never. */
static void listen(const case_plan *plan, long every, archive *from, listener *l)
{
    const dae *dae = &model_about(plan->model)->dae;
    evl_error error;
    dae_state state = dae_state_create(dae, NULL);
    simulate_result result;
    *l = (listener){.every = every};
    if (from == NULL) {
        dae_state_free(&state);
        assert_true(case_start(plan, NULL, &state, NULL, &error));
    }
    want_all(&l->requested, plan->model, &l->arena);
    l->extremes = extremes_create(plan->model, plan->description->n_meshes, -INFINITY, INFINITY);
    if (plan->description->simulation.metrics.is_set) {
        bool all[N_METRIC_ROWS];
        memset(all, true, sizeof all);
        l->metrics = metrics_create(plan->model, &plan->window, all);
    }
    const simulate_sink sink = {.self = l,
                                .requested = &l->requested,
                                .outputs = on_outputs,
                                .event = on_event,
                                .extremes = l->extremes,
                                .metrics = l->metrics,
                                .is_due = every > 0 ? is_due : NULL,
                                .serialize = serialize,
                                .write_checkpoint = on_checkpoint,
                                .resume = from};
    simulate(plan, &sink, &state, &result);
    assert_int_equal(result.end, SIMULATE_DONE);
    append_end(l, plan, &result);
    dae_state_free(&state);
    extremes_delete(&l->extremes);
    metrics_delete(&l->metrics);
}

static void forget(listener *l)
{
    archive_free(&l->recorded);
    arena_free(&l->arena);
}

/* How many rests a run has: nothing is kept of it. */
static bool count(void *self, double t)
{
    (void)t;
    listener *l = self;
    l->rests++;
    return false;
}

static bool hear_nothing(void *self, const output_block *block)
{
    (void)self, (void)block;
    return true;
}

static bool hear_no_event(void *self, const event_record *record)
{
    (void)self, (void)record;
    return true;
}

static long rests_of(const case_plan *plan)
{
    evl_error error;
    dae_state state;
    simulate_result result;
    listener l = {.every = 1};
    want_all(&l.requested, plan->model, &l.arena);
    assert_true(case_start(plan, NULL, &state, NULL, &error));
    const simulate_sink sink = {.self = &l,
                                .requested = &l.requested,
                                .outputs = hear_nothing,
                                .event = hear_no_event,
                                .is_due = count,
                                .serialize = serialize,
                                .write_checkpoint = on_checkpoint};
    simulate(plan, &sink, &state, &result);
    assert_int_equal(result.end, SIMULATE_DONE);
    dae_state_free(&state);
    arena_free(&l.arena);
    return l.rests;
}

typedef struct {
    const char *name, *path;
    const char *set[MOST_SETS];
} sample;

static int n_sets(const sample *sample)
{
    int n = 0;
    while (n < MOST_SETS && sample->set[n] != NULL) {
        n++;
    }
    return n;
}

static void goes_on_with_the_same_bits(void **state)
{
    const sample *sample = *state;
    case_plan plan = {0};
    evl_error error = {.code = EVL_EXIT_OK};
    listener whole, other;
    if (!case_plan_make(&plan, &(plan_request){.name = sample->path, .n_set = n_sets(sample), .set = sample->set},
                        &error)) {
        fail_msg("%s: %s", error.location, error.message);
    }
    const long rests = rests_of(&plan);
    assert_true(rests > 3 * MAX_CHECKPOINTS);
    listen(&plan, rests / (MAX_CHECKPOINTS + 1), NULL, &whole);
    assert_int_equal(whole.n_checkpoints, MAX_CHECKPOINTS);
    if (plan.integration.by_stepper) { /* to be kept changes nothing */
        listen(&plan, 0, NULL, &other);
        assert_int_equal(other.recorded.n, whole.recorded.n);
        assert_memory_equal(other.recorded.bytes, whole.recorded.bytes, whole.recorded.n);
        forget(&other);
    }
    for (int i = 0; i < MAX_CHECKPOINTS; i++) {
        const keepsake *one = &whole.checkpoints[i];
        archive from = {.is_reading = true, .bytes = one->bytes, .n = one->n};
        listen(&plan, rests / (MAX_CHECKPOINTS + 1), &from, &other);
        assert_int_equal(other.recorded.n, whole.recorded.n - one->recorded);
        assert_memory_equal(other.recorded.bytes, whole.recorded.bytes + one->recorded, other.recorded.n);
        forget(&other);
    }
    forget(&whole);
    case_plan_free(&plan);
}

/* What is cut off, or of another case, is refused. */
static void refuse(const case_plan *plan, keepsake one)
{
    listener l = {.every = 1};
    simulate_result result;
    archive from = {.is_reading = true, .bytes = one.bytes, .n = one.n};
    dae_state state = dae_state_create(&model_about(plan->model)->dae, NULL);
    want_all(&l.requested, plan->model, &l.arena);
    l.extremes = extremes_create(plan->model, plan->description->n_meshes, -INFINITY, INFINITY);
    const simulate_sink sink = {.self = &l,
                                .requested = &l.requested,
                                .outputs = on_outputs,
                                .event = on_event,
                                .extremes = l.extremes,
                                .is_due = is_due,
                                .serialize = serialize,
                                .write_checkpoint = on_checkpoint,
                                .resume = &from};
    simulate(plan, &sink, &state, &result);
    assert_int_equal(result.end, SIMULATE_FAILED);
    assert_string_equal(result.message, "the stored state does not belong to this case and program");
    dae_state_free(&state);
    extremes_delete(&l.extremes);
    forget(&l);
}

static void is_refused_if_it_is_cut_off_or_of_another_case(void **state)
{
    (void)state;
    static const char *const set[] = {"simulation.integrator=radau", "simulation.duration=0.01"};
    case_plan plan = {0}, other = {0};
    evl_error error;
    listener l;
    assert_true(
        case_plan_make(&plan, &(plan_request){.name = "examples/spur-pair.yaml", .n_set = 2, .set = set}, &error));
    assert_true(case_plan_make(&other, &(plan_request){.name = "examples/two-stage-gears.yaml", .n_set = 2, .set = set},
                               &error));
    listen(&plan, 3, NULL, &l);
    for (size_t n = 0; n < l.checkpoints[0].n; n += 1 + l.checkpoints[0].n / 100) {
        refuse(&plan, (keepsake){l.checkpoints[0].bytes, n, 0});
    }
    refuse(&other, l.checkpoints[0]);
    forget(&l);
    case_plan_free(&plan);
    case_plan_free(&other);
}

/* Every tracking, either integrator; friction that sticks, rattle, trains, wheels that yield, outputs by position, numbers. */
#define RADAU "simulation.integrator=radau"
#define IDA "simulation.integrator=ida"
#define CLOSED "meshes.0.tracking=closed_form"
static sample samples[] = {
    {"paper, algebraic", "examples/paper.yaml", {"meshes.0.tracking=algebraic"}},
    {"paper, differential", "examples/paper.yaml", {"meshes.0.tracking=differential"}},
    {"paper, closed form, ida", "examples/paper.yaml", {CLOSED, IDA}},
    {"friction, radau", "examples/paper-friction.yaml", {CLOSED, RADAU}},
    {"friction, ida", "examples/paper-friction.yaml", {IDA}},
    {"rigid", "examples/paper-rigid-friction.yaml", {IDA}},
    {"rattle, radau", "examples/rattle.yaml", {RADAU}},
    {"rattle, ida", "examples/rattle.yaml", {IDA}},
    {"spur pair", "examples/spur-pair.yaml", {RADAU}},
    {"tip relief", "examples/tip-relief.yaml", {RADAU}},
    {"tip relief, ida", "examples/tip-relief.yaml", {IDA}},
    {"train", "examples/two-stage-gears.yaml", {RADAU}},
    {"train, ida", "examples/two-stage-gears.yaml", {IDA, "simulation.duration=0.01"}},
    {"shafts", "examples/two-stage.yaml", {RADAU, "simulation.duration=0.02"}},
    {"compliance", "examples/compliant-pair.yaml", {RADAU, "simulation.duration=0.01"}},
    {"motor", "examples/motor-driven.yaml", {RADAU, "simulation.duration=0.1"}},
    {"numbers by position", "examples/tutorial-pair.yaml", {RADAU, "simulation.duration=0.08"}},
    {"numbers by position, ida",
     "examples/tutorial-pair.yaml",
     {IDA, "simulation.duration=0.02", "simulation.metrics={from: 5 ms}"}},
    {"turns",
     "examples/high-speed-pair.yaml",
     {RADAU, "simulation.duration=0.03", "simulation.metrics={turns_of: pinion}"}},
};

int main(void)
{
    enum { N = sizeof samples / sizeof *samples };
    struct CMUnitTest tests[N + 1] = {[N] = cmocka_unit_test(is_refused_if_it_is_cut_off_or_of_another_case)};
    for (int i = 0; i < N; i++) {
        tests[i] = (struct CMUnitTest){
            .name = samples[i].name, .test_func = goes_on_with_the_same_bits, .initial_state = &samples[i]};
    }
    return cmocka_run_group_tests(tests, NULL, NULL);
}
