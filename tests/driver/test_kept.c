/* A simulation that is kept between two steps and goes on in other memory gives the bits of one that was not: outputs, events, extremes,
 * numbers, counts, invariants. With IDA both are kept at the same times. */
#include "base/archive.h"
#include "base/memory.h"
#include "simulate/prepare.h"
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

enum { MOST_KEPT = 5, MOST_SETS = 4 };

/* What was kept, and how much had been told by then. */
typedef struct {
    unsigned char *bytes;
    size_t n, told;
} keepsake;

typedef struct {
    memory_pool pool;
    wanted_outputs wanted;
    extremes *extremes;
    numbers *numbers;
    archive told;             /**< all that was told, one after the other */
    long every, rests, n_due; /**< every so many rests it is due, up to MOST_KEPT times */
    int n_kept;
    keepsake kept[MOST_KEPT];
} listener;

static void tell(listener *l, const void *bytes, size_t n)
{
    memcpy(archive_take(&l->told, n), bytes, n);
}

static bool on_outputs(void *self, const output_block *block)
{
    listener *l = self;
    for (int k = 0; k < block->n; k++) {
        tell(l, &block->t[k], sizeof(double));
        for (int i = 0; i < l->wanted.n_values; i++) {
            tell(l, &output_values(block, i)[k], sizeof(double));
        }
        if (block->marks != NULL) {
            tell(l, &block->marks[k].position, sizeof(double));
            tell(l, &block->marks[k].kind, sizeof block->marks[k].kind);
        }
    }
    return true;
}

static bool on_event(void *self, const event_record *record)
{
    listener *l = self;
    tell(l, &record->t, sizeof record->t);
    tell(l, &record->what, sizeof record->what);
    tell(l, record->before->y, (size_t)record->n * sizeof(double));
    tell(l, record->after->y, (size_t)record->n * sizeof(double));
    return true;
}

static bool is_due(void *self, double t)
{
    listener *l = self;
    (void)t;
    return ++l->rests % l->every == 0 && l->n_due < MOST_KEPT;
}

static void keep(void *self, archive *archive)
{
    listener *l = self;
    l->n_due += !archive->is_reading;
    KEEP(archive, l->rests);
    KEEP(archive, l->n_due);
}

static simulate_kept on_kept(void *self, double t, const archive *archive)
{
    listener *l = self;
    (void)t;
    keepsake *one = &l->kept[l->n_kept++];
    *one = (keepsake){pool_calloc(&l->pool, archive->n, 1), archive->n, l->told.n};
    memcpy(one->bytes, archive->bytes, archive->n);
    return SIMULATE_GOES_ON;
}

static void tell_end(listener *l, const prepared_case *prepared, simulate_result *result)
{
    const model *model = prepared->model;
    POOLED memory_pool pool = {NULL};
    model_output rows[N_NUMBER_ROWS];
    const int n = number_rows_place(&model_about(model)->names, rows);
    double *values = pool_calloc(&pool, (size_t)n, sizeof *values);
    for (int k = 0; k < model_tables()->n_extremes; k++) {
        for (int mesh = 0; mesh < case_description(prepared->file)->n_meshes; mesh++) {
            const extreme_found found = extremes_found(l->extremes, k, mesh);
            tell(l, &found, sizeof found);
        }
    }
    if (l->numbers != NULL) {
        numbers_conclude(l->numbers, values);
        tell(l, values, (size_t)n * sizeof *values);
    }
    result->counts.cpu_seconds = 0;
    tell(l, &result->counts, sizeof result->counts);
    tell(l, &result->t, sizeof result->t);
    tell(l, &result->energy_residual, sizeof result->energy_residual);
    tell(l, result->remark, strlen(result->remark));
    tell(l, result->invariants, strlen(result->invariants));
}

static void want_all(wanted_outputs *wanted, const model *model, memory_pool *pool)
{
    const model_facts *about = model_about(model);
    wanted_init(wanted, model, pool);
    for (int i = 0; i < about->n_outputs; i++) {
        if (!about->outputs[i].is_static) {
            (void)wanted_add(wanted, about->outputs[i].name);
        }
    }
}

/* From the start, or from what was kept; it is kept every so many rests, or never. */
static void listen(const prepared_case *prepared, long every, archive *from, listener *l)
{
    const dae *dae = &model_about(prepared->model)->dae;
    const numbers_description *asked = &case_description(prepared->file)->simulation.numbers;
    evl_error error;
    dae_state state = dae_state_create(dae, NULL);
    simulate_result result;
    *l = (listener){.every = every};
    if (from == NULL) {
        dae_state_free(&state);
        assert_true(prepare_start(prepared, &state, &error));
    }
    want_all(&l->wanted, prepared->model, &l->pool);
    l->extremes = extremes_create(prepared->model, case_description(prepared->file)->n_meshes, -INFINITY, INFINITY);
    if (asked->is_given) {
        bool all[N_NUMBER_ROWS];
        memset(all, true, sizeof all);
        const number_window window = {.from = asked->from, .to = asked->to, .mesh = asked->mesh, .wheel = asked->wheel};
        l->numbers = numbers_create(prepared->model, &window, all);
    }
    const simulate_sink sink = {.self = l,
                                .wanted = &l->wanted,
                                .outputs = on_outputs,
                                .event = on_event,
                                .extremes = l->extremes,
                                .numbers = l->numbers,
                                .is_due = every > 0 ? is_due : NULL,
                                .keep = keep,
                                .kept = on_kept,
                                .resume = from};
    simulate(prepared, &sink, &state, &result);
    assert_int_equal(result.end, SIMULATE_DONE);
    tell_end(l, prepared, &result);
    dae_state_free(&state);
    extremes_delete(&l->extremes);
    numbers_delete(&l->numbers);
}

static void forget(listener *l)
{
    archive_free(&l->told);
    pool_free(&l->pool);
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

static long rests_of(const prepared_case *prepared)
{
    evl_error error;
    dae_state state;
    simulate_result result;
    listener l = {.every = 1};
    want_all(&l.wanted, prepared->model, &l.pool);
    assert_true(prepare_start(prepared, &state, &error));
    const simulate_sink sink = {.self = &l,
                                .wanted = &l.wanted,
                                .outputs = hear_nothing,
                                .event = hear_no_event,
                                .is_due = count,
                                .keep = keep,
                                .kept = on_kept};
    simulate(prepared, &sink, &state, &result);
    assert_int_equal(result.end, SIMULATE_DONE);
    dae_state_free(&state);
    pool_free(&l.pool);
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
    prepared_case prepared;
    evl_error error = {.code = EVL_EXIT_OK};
    listener whole, other;
    if (!prepare_case(&prepared, sample->path, n_sets(sample), sample->set, &error)) {
        fail_msg("%s: %s", error.place, error.message);
    }
    const long rests = rests_of(&prepared);
    assert_true(rests > 3 * MOST_KEPT);
    listen(&prepared, rests / (MOST_KEPT + 1), NULL, &whole);
    assert_int_equal(whole.n_kept, MOST_KEPT);
    if (simulate_options(&prepared).by_stepper) { /* to be kept changes nothing */
        listen(&prepared, 0, NULL, &other);
        assert_int_equal(other.told.n, whole.told.n);
        assert_memory_equal(other.told.bytes, whole.told.bytes, whole.told.n);
        forget(&other);
    }
    for (int i = 0; i < MOST_KEPT; i++) {
        const keepsake *one = &whole.kept[i];
        archive from = {.is_reading = true, .bytes = one->bytes, .n = one->n};
        listen(&prepared, rests / (MOST_KEPT + 1), &from, &other);
        assert_int_equal(other.told.n, whole.told.n - one->told);
        assert_memory_equal(other.told.bytes, whole.told.bytes + one->told, other.told.n);
        forget(&other);
    }
    forget(&whole);
    prepared_case_free(&prepared);
}

/* What is cut off, or of another case, is refused. */
static void refuse(const prepared_case *prepared, keepsake one)
{
    listener l = {.every = 1};
    simulate_result result;
    archive from = {.is_reading = true, .bytes = one.bytes, .n = one.n};
    dae_state state = dae_state_create(&model_about(prepared->model)->dae, NULL);
    want_all(&l.wanted, prepared->model, &l.pool);
    l.extremes = extremes_create(prepared->model, case_description(prepared->file)->n_meshes, -INFINITY, INFINITY);
    const simulate_sink sink = {.self = &l,
                                .wanted = &l.wanted,
                                .outputs = on_outputs,
                                .event = on_event,
                                .extremes = l.extremes,
                                .is_due = is_due,
                                .keep = keep,
                                .kept = on_kept,
                                .resume = &from};
    simulate(prepared, &sink, &state, &result);
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
    prepared_case prepared, other;
    evl_error error;
    listener l;
    assert_true(prepare_case(&prepared, "examples/spur-pair.yaml", 2, set, &error));
    assert_true(prepare_case(&other, "examples/two-stage-gears.yaml", 2, set, &error));
    listen(&prepared, 3, NULL, &l);
    for (size_t n = 0; n < l.kept[0].n; n += 1 + l.kept[0].n / 100) {
        refuse(&prepared, (keepsake){l.kept[0].bytes, n, 0});
    }
    refuse(&other, l.kept[0]);
    forget(&l);
    prepared_case_free(&prepared);
    prepared_case_free(&other);
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
