/* Runs of the library. */
#include "analyses/run_history.h"
#include "base/memory.h"
#include "library/boundary.h"
#include "library/library.h"
#include "simulate/case_start.h"

typedef struct {
    const case_plan *plan;
    const volatile sig_atomic_t *stop;
    model_start_orbit start; /**< orbit of a periodic start */
    run_history history;
    history *in_memory;
    evolvent_record *record;
    evl_error error;
} run;

static bool on_outputs(void *self, const output_block *block)
{
    run *run = self;
    return run_history_outputs(&run->history, block, &run->error);
}

static bool on_event(void *self, const event_record *record)
{
    run *run = self;
    return run_history_event(&run->history, record, &run->error);
}

static void conclude(run *run, const simulate_result *result)
{
    CLEANUP_FREE char *location = xasprintf("%s: t = %.9g s", run->plan->path, result->t);
    if (result->end == SIMULATE_SINK_FAILED || !run_history_put(&run->history, &run->error)) {
        run_history_abandon(&run->history);
        return;
    }
    if (result->end == SIMULATE_INTERRUPTED) {
        evl_error_set(&run->error, EVL_EXIT_INTERRUPTED, location, "interrupted by %s", library_who(0));
    } else if (result->end == SIMULATE_FAILED) {
        evl_error_set(&run->error, EVL_EXIT_INTEGRATION, location, "%s", result->message);
    }
    (void)run_history_close(&run->history, library_who(0), result, "", &run->error);
}

static void simulate_case(void *with)
{
    run *run = with;
    dae_state start;
    simulate_result result;
    if (!case_start(run->plan, run->stop, &start, &run->start, &run->error)) {
        return;
    }
    run_history_init(&run->history, run->plan, &run->start);
    run->history.layout.in_memory = &run->in_memory;
    if (run_history_open(&run->history, run->plan->path, &run->error)) {
        simulate_sink sink = {.self = run, .outputs = on_outputs, .event = on_event, .interrupt = run->stop};
        run_history_simulate(&run->history, &sink, &start, NULL, &result);
        conclude(run, &result);
    }
    run_history_free(&run->history);
    dae_state_free(&start);
    run->record = library_record(run->in_memory);
}

evolvent_code evolvent_run(const evolvent_case *gearbox, const volatile int *stop, evolvent_record **record,
                           evolvent_error *error)
{
    run run = {.plan = &gearbox->plan, .stop = stop != NULL ? stop : &library_never};
    boundary_call(simulate_case, &run, &run.error);
    *record = run.record;
    return library_report_error(&run.error, error);
}
