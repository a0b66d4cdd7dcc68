/* Where outputs show a missed event before the first checkpoint, the run begins anew from its start, and nothing is left of what came
 * before: neither in its history nor in what its checkpoints say. */
#include "analyses/run_history.h"
#include "base/memory.h"
#include "commands/checkpoints.h"
#include "simulate/case_start.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

enum { N_FIRST = 24, ALL = 1000000 };
static const double t_first = 0.31; /* of the checkpoint at which the missed event shows [s] */
static const char *const set[] = {
    "meshes.0.tracking=closed_form",
    "simulation={duration: 0.9, output_interval: 0.01, tolerance: 1e-5, integrator: ida}"};
static const checkpoint_options begins = {.at = "0.3,0.6"}, goes_on = {.at = "0.3,0.6", .continues = true};

/* As `evolvent run` does, but that it gives up after so many rows. */
typedef struct {
    case_plan plan;
    run_history history;
    checkpoints *checkpoints;
    evl_error error;
    int n_left;
} writer;

static bool has_part(writer *w, int n_rows, int n_events)
{
    checkpoints_count(w->checkpoints, n_rows, n_events);
    return w->history.history != NULL || run_history_open(&w->history, checkpoints_part(w->checkpoints), &w->error);
}

static bool on_outputs(void *self, const output_block *block)
{
    writer *w = self;
    w->n_left -= block->n;
    return has_part(w, block->n, 0) && run_history_outputs(&w->history, block, &w->error) && w->n_left > 0;
}

static bool on_event(void *self, const event_record *record)
{
    writer *w = self;
    return has_part(w, 0, 1) && run_history_event(&w->history, record, &w->error);
}

static bool is_due(void *self, double t)
{
    const writer *w = self;
    return checkpoints_is_due(w->checkpoints, t);
}

static void serialize(void *self, archive *archive)
{
    const writer *w = self;
    checkpoints_serialize(w->checkpoints, archive);
}

static simulate_checkpoint_outcome write_checkpoint(void *self, double t, const archive *archive)
{
    writer *w = self;
    return checkpoints_write(w->checkpoints, &w->history.history, t, archive, &w->error);
}

static void simulate_to(writer *w, int n_rows, simulate_result *result)
{
    dae_state state;
    assert_true(case_start(&w->plan, NULL, &state, NULL, &w->error));
    run_history_monitor(&w->history);
    const simulate_sink sink = {.self = w,
                                .requested = &w->history.requested,
                                .waits = true,
                                .outputs = on_outputs,
                                .event = on_event,
                                .extremes = w->history.extremes,
                                .is_due = is_due,
                                .serialize = serialize,
                                .write_checkpoint = write_checkpoint};
    w->n_left = n_rows;
    simulate(&w->plan, &sink, &state, result);
    dae_state_free(&state);
}

/** What a run has done until the outputs before its first checkpoint show that an event was missed. */
static void begin_in_vain(writer *w)
{
    simulate_result result;
    archive archive = {.is_reading = false};
    simulate_to(w, N_FIRST, &result);
    assert_int_equal(result.end, SIMULATE_SINK_FAILED);
    assert_non_null(w->history.history);
    assert_true(checkpoints_is_due(w->checkpoints, t_first));
    checkpoints_serialize(w->checkpoints, &archive); /* its outputs come with it, and end it */
    archive_free(&archive);
    CLEANUP_FREE char *partial = xasprintf("%s.partial", checkpoints_part(w->checkpoints));
    run_history_abandon(&w->history);
    assert_int_equal(access(partial, F_OK), 0);
    assert_true(checkpoints_again(w->checkpoints, &w->error));
    assert_int_not_equal(access(partial, F_OK), 0);
}

static char *read_bytes(const char *path, size_t *size)
{
    enum { MOST = 10000000 };
    char *bytes = xcalloc(1, MOST);
    FILE *file = fopen(path, "rb");
    *size = file == NULL ? 0 : fread(bytes, 1, MOST, file);
    assert_true(file != NULL && fclose(file) == 0);
    assert_true(*size > 0 && *size < MOST);
    assert_int_equal(unlink(path), 0);
    return bytes;
}

/* The bytes of the history of all parts. */
static char *write_history(const char *folder, bool in_vain, size_t *size)
{
    simulate_result result;
    writer w = {.n_left = 0};
    CLEANUP_FREE char *path = xasprintf("%s/x.h5", folder);
    assert_true(case_plan_make(&w.plan, &(plan_request){.name = "examples/paper-friction.yaml", .n_set = 2, .set = set},
                               &w.error));
    w.checkpoints = checkpoints_open(&begins, path, "", &w.plan, &w.error);
    assert_non_null(w.checkpoints);
    run_history_init(&w.history, &w.plan, &(model_start_orbit){0});
    if (in_vain) {
        begin_in_vain(&w);
        assert_string_equal(checkpoints_times(w.checkpoints), "");
    }
    simulate_to(&w, ALL, &result);
    assert_int_equal(result.end, SIMULATE_DONE);
    assert_true(checkpoints_close_part(w.checkpoints, &w.history.history, &w.error));
    assert_true(run_history_open(&w.history, path, &w.error));
    assert_true(checkpoints_append(w.checkpoints, w.history.history, &w.error));
    assert_true(run_history_close(&w.history, "", &result, checkpoints_times(w.checkpoints), &w.error));
    checkpoints_close(&w.checkpoints);
    w.checkpoints = checkpoints_open(&goes_on, path, "", &w.plan, &w.error); /* holds its parts against it */
    assert_non_null(w.checkpoints);
    assert_true(checkpoints_time(w.checkpoints) >= 0.6);
    checkpoints_remove(w.checkpoints);
    checkpoints_close(&w.checkpoints);
    run_history_free(&w.history);
    case_plan_free(&w.plan);
    return read_bytes(path, size);
}

static void a_run_that_begins_anew_before_its_first_checkpoint_keeps_nothing(void **state)
{
    (void)state;
    char folder[] = "/tmp/test_checkpoints_XXXXXX";
    assert_non_null(mkdtemp(folder));
    size_t n_once, n_anew;
    CLEANUP_FREE char *once = write_history(folder, false, &n_once);
    CLEANUP_FREE char *anew = write_history(folder, true, &n_anew);
    assert_int_equal(n_once, n_anew);
    assert_memory_equal(once, anew, n_once);
    assert_int_equal(rmdir(folder), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_run_that_begins_anew_before_its_first_checkpoint_keeps_nothing)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
