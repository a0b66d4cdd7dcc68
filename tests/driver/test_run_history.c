/* A simulation that is made anew writes the history that one would have written. */
#include "analyses/run_history.h"
#include "base/memory.h"
#include "simulate/case_start.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

static const char *const set[] = {"meshes.0.tracking=closed_form",
                                  "simulation={duration: 0.9, output_interval: 0.01, tolerance: 1e-5}"};

/* Writes, and gives up after so many rows. */
typedef struct {
    run_history history;
    evl_error error;
    int n_left;
} writer;

static bool on_outputs(void *self, const output_block *block)
{
    writer *w = self;
    w->n_left -= block->n;
    return run_history_outputs(&w->history, block, &w->error) && w->n_left > 0;
}

static bool on_event(void *self, const event_record *record)
{
    writer *w = self;
    return run_history_event(&w->history, record, &w->error);
}

static void simulate_to(writer *w, const case_plan *plan, bool waits, int n_rows, simulate_result *result)
{
    dae_state state;
    assert_true(case_start(plan, NULL, &state, NULL, &w->error));
    const simulate_sink sink = {
        .self = w, .requested = &w->history.requested, .waits = waits, .outputs = on_outputs, .event = on_event};
    w->n_left = n_rows;
    simulate(plan, &sink, &state, result);
    dae_state_free(&state);
}

/* The file's bytes. */
static char *write_history(const char *folder, int n_first, size_t *size)
{
    static const int all = 1000000;
    case_plan plan = {0};
    simulate_result result;
    writer w = {.n_left = 0};
    CLEANUP_FREE char *path = xasprintf("%s/x.h5", folder);
    assert_true(case_plan_make(&plan, &(plan_request){.name = "examples/paper-friction.yaml", .n_set = 2, .set = set},
                               &w.error));
    run_history_init(&w.history, &plan, &(model_start_orbit){0});
    assert_true(run_history_open(&w.history, path, &w.error));
    if (n_first > 0) {
        simulate_to(&w, &plan, true, n_first, &result);
        assert_int_equal(result.end, SIMULATE_SINK_FAILED);
        assert_true(w.history.rows.written >= n_first && w.history.events.written > 0);
        run_history_again(&w.history);
    }
    simulate_to(&w, &plan, n_first == 0, all, &result);
    assert_int_equal(result.end, SIMULATE_DONE);
    assert_int_equal(w.history.rows.written, 91);
    assert_true(run_history_close(&w.history, "", &result, "", &w.error));
    run_history_free(&w.history);
    case_plan_free(&plan);
    enum { MOST = 10000000 };
    char *bytes = xcalloc(1, MOST);
    FILE *file = fopen(path, "rb");
    *size = file == NULL ? 0 : fread(bytes, 1, MOST, file);
    assert_true(file != NULL && fclose(file) == 0);
    assert_true(*size > 0 && *size < MOST);
    assert_int_equal(unlink(path), 0);
    return bytes;
}

static void a_simulation_made_anew_writes_what_is_not_written_yet(void **state)
{
    (void)state;
    char folder[] = "/tmp/test_run_history_XXXXXX";
    assert_non_null(mkdtemp(folder));
    size_t n_once, n_anew;
    CLEANUP_FREE char *once = write_history(folder, 0, &n_once);
    CLEANUP_FREE char *anew = write_history(folder, 60, &n_anew);
    assert_int_equal(n_once, n_anew);
    assert_memory_equal(once, anew, n_once);
    assert_int_equal(rmdir(folder), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(a_simulation_made_anew_writes_what_is_not_written_yet)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
