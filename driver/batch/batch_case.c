#include "batch/batch_case.h"

#include "base/json.h"
#include "base/log.h"
#include "base/memory.h"
#include "base/words.h"
#include "batch/batch_checkpointer.h"
#include "batch/batch_response.h"
#include "model/model_start.h"
#include "simulate/case_start.h"
#include "simulate/simulate.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

/** Start of a case. */
typedef struct {
    dae_state state;         /**< at t = 0; to be freed */
    model_start_orbit orbit; /**< of a periodic start */
    metric_window window;
} batch_start;

typedef struct {
    const batch_plan *plan;
    memory_arena arena;
    requested_outputs requested;
    statistics *statistics;
    float *history; /**< a row of the stack; NULL if there are no histories */
    int *columns;   /**< of the history's variables among the outputs; -1: the time */
    long n_outputs; /**< so far */
    batch_checkpointer *checkpointer;
} batch_sink;

void batch_case_lost(const batch_plan *plan, long index, const char *message, batch_row *row)
{
    batch_row_write(plan, index, JOURNAL_FAILED, message, NULL, NULL, row);
}

/* ---- checks of a case ---- */

/** Window of a case: the design's times, or the case's own. @return false if it contains no output */
static bool find_window(const double given[2], const case_plan *of_case, metric_window *window)
{
    const double dt = of_case->integration.output_interval, end = of_case->integration.t_end, slack = 1e-6;
    *window = of_case->window;
    window->from = isnan(given[0]) ? window->from : given[0];
    window->to = isnan(given[1]) ? window->to : given[1];
    if (of_case->positions.per != NULL) { /* output times are not known in advance */
        return window->from <= end;
    }
    const double first = ceil(window->from / dt - slack) * dt; /* on the grid */
    const bool has_grid_point = first <= fmin(window->to, end) + slack * dt;
    const bool has_end = window->from <= end && end <= window->to;
    return has_grid_point || has_end;
}

static bool has_history_shape(const batch_plan *plan, const case_plan *of_case)
{
    const batch_histories *histories = &plan->histories;
    bool good = batch_axis_fits(&histories->axis, of_case);
    for (int i = 0; i < histories->n_variables && good; i++) {
        const model_output *requested = &histories->variables[i];
        const model_output *output = model_output_named(of_case->model, requested->name);
        good = requested->offset < 0 || (output != NULL && output->count == requested->count);
    }
    return good;
}

/** @return false with the reason in `refusal` */
static bool check_case(const batch_plan *plan, const case_plan *of_case, metric_window *window, evl_error *refusal)
{
    const description *description = of_case->description;
    const char *at = of_case->path;
    if (description->n_meshes != plan->table.n_meshes) {
        return evl_error_set(
            refusal, EVL_EXIT_CASE, at,
            "the number of meshes is %d, that of the base case %d; all cases of a design have the same meshes",
            description->n_meshes, plan->table.n_meshes);
    }
    if (plan->table.n_metrics > 0 && (description->n_wheels != plan->table.names.wheels.n ||
                                      description->n_accelerometers != plan->table.names.accelerometers.n)) {
        return evl_error_set(refusal, EVL_EXIT_CASE, at,
                             "has %d wheels and %d accelerometers, the base case %d and %d; with metrics over whole "
                             "periods all cases need the same",
                             description->n_wheels, description->n_accelerometers, plan->table.names.wheels.n,
                             plan->table.names.accelerometers.n);
    }
    if (!find_window(plan->design->window, of_case, window)) {
        return evl_error_set(refusal, EVL_EXIT_CASE, at,
                             "the window from %g to %g s contains no output of this case, which ends at %g s",
                             window->from, window->to, of_case->integration.t_end);
    }
    return plan->histories.n_variables == 0 || has_history_shape(plan, of_case) ||
           evl_error_set(refusal, EVL_EXIT_CASE, at,
                         "its history differs in times, positions or sizes from those of the other cases; plan it "
                         "without histories");
}

/* ---- outputs of the simulation ---- */

/** Store one output of a stacked history, if it is on the axis; of several at one position the first. */
static void store_output(const batch_sink *sink, const output_block *block, int time)
{
    const batch_histories *histories = &sink->plan->histories;
    const output_mark *mark = block->marks == NULL ? NULL : &block->marks[time];
    const long k = batch_axis_index(&histories->axis, sink->n_outputs, block->t[time], mark);
    float *to = sink->history;
    if (k < 0 || (histories->axis.rule.per != NULL && !isnan(to[k]))) {
        return;
    }
    for (int i = 0; i < histories->n_variables; i++) {
        const int count = histories->variables[i].count, at = sink->columns[i];
        for (int j = 0; j < count; j++) {
            to[k * count + j] = (float)(at < 0 ? block->t[time] : output_values(block, at + j)[time]);
        }
        to += (long)histories->axis.coordinate.n * count;
    }
}

static bool on_outputs(void *self, const output_block *block)
{
    batch_sink *sink = self;
    statistics_outputs(sink->statistics, block);
    for (int k = 0; k < block->n && sink->history != NULL; k++) {
        store_output(sink, block, k);
        sink->n_outputs++;
    }
    return true;
}

static bool on_event(void *self, const event_record *record)
{
    const batch_sink *sink = self;
    statistics_event(sink->statistics, record);
    return true;
}

static bool is_due(void *self, double t)
{
    const batch_sink *sink = self;
    (void)t;
    return batch_checkpointer_is_due(sink->checkpointer);
}

/** Serialise what the simulation does not. */
static void serialize(void *self, archive *archive)
{
    batch_sink *sink = self;
    statistics_serialize(sink->statistics, archive);
    SERIALIZE(archive, sink->n_outputs);
    if (sink->history != NULL) {
        SERIALIZE_ARRAY(archive, sink->history, stack_row_length(&sink->plan->stack));
    }
}

static simulate_checkpoint_outcome write_checkpoint(void *self, double t, const archive *archive)
{
    const batch_sink *sink = self;
    return batch_checkpointer_write(sink->checkpointer, t, archive);
}

static void start_history(batch_sink *sink)
{
    const batch_histories *histories = &sink->plan->histories;
    if (histories->n_variables == 0) {
        return;
    }
    const long n = stack_row_length(&sink->plan->stack);
    sink->history = arena_calloc(&sink->arena, (size_t)n, sizeof *sink->history);
    sink->columns = arena_calloc(&sink->arena, (size_t)histories->n_variables, sizeof *sink->columns);
    for (long i = 0; i < n; i++) {
        sink->history[i] = NAN;
    }
    for (int i = 0; i < histories->n_variables; i++) {
        sink->columns[i] = requested_outputs_add(&sink->requested, histories->variables[i].name);
    }
}

/* ---- the case ---- */

/** Warnings of `evolvent run`, except those of the base case's own numbers, which are printed once. */
static char *remarks(const case_plan *of_case, const model_start_orbit *orbit, const char *remark)
{
    CLEANUP_FREE char *warnings = case_plan_own_warnings(of_case, orbit, "; ");
    return xasprintf("%s%s%s", warnings, warnings[0] != '\0' && remark[0] != '\0' ? "; " : "", remark);
}

/** A case with outputs by position fails if none of them is in its window. */
static void check_window(const batch_sink *sink, simulate_result *result)
{
    if (result->end == SIMULATE_DONE && !statistics_has_outputs(sink->statistics)) {
        result->end = SIMULATE_FAILED;
        (void)snprintf(result->message, sizeof result->message,
                       "the window contains no output; start it earlier, or increase the duration");
    }
}

static void conclude(const batch_sink *sink, const model_start_orbit *orbit, const simulate_result *result,
                     batch_row *row)
{
    const batch_plan *plan = sink->plan;
    const case_plan *of_case = sink->checkpointer->of_case;
    const bool is_done = result->end == SIMULATE_DONE;
    CLEANUP_FREE double *results = xcalloc((size_t)plan->table.n, sizeof *results);
    statistics_finish(sink->statistics, result, model_start_multiplier(orbit), results);
    CLEANUP_FREE char *invariants =
        result->held ? xstrdup("") : xasprintf("its own invariants are %s", result->invariants);
    const metrics *metrics = statistics_metrics(sink->statistics);
    const char *unsettled = metrics == NULL ? "" : metrics_settled(metrics)->reason;
    CLEANUP_FREE char *window =
        unsettled[0] == '\0' ? xstrdup("") : xasprintf("the window may not be settled: %s", unsettled);
    const char *const all[] = {result->remark, window, invariants};
    const char *reported[3];
    int n_reported = 0;
    for (int i = 0; i < 3; i++) {
        if (all[i][0] != '\0') {
            reported[n_reported++] = all[i];
        }
    }
    CLEANUP_FREE char *remark = words_join(n_reported, reported, "; ");
    CLEANUP_FREE char *message =
        is_done ? remarks(of_case, orbit, remark) : xasprintf("failed at t = %.9g s: %s", result->t, result->message);
    batch_row_write(plan, sink->checkpointer->index, is_done ? JOURNAL_DONE : JOURNAL_FAILED, message, results,
                    sink->history, row);
}

static void sink_start(batch_sink *sink, const metric_window *window)
{
    const batch_plan *plan = sink->plan;
    const case_plan *of_case = sink->checkpointer->of_case;
    *sink = (batch_sink){.plan = plan, .checkpointer = sink->checkpointer};
    requested_outputs_init(&sink->requested, of_case->model, &sink->arena);
    sink->statistics = statistics_create(&plan->table, &sink->requested, window, of_case->integration.output_interval);
    start_history(sink);
}

static void sink_end(batch_sink *sink)
{
    statistics_delete(&sink->statistics);
    arena_free(&sink->arena);
}

static void simulate_once(batch_sink *sink, const batch_start *start, simulate_result *result)
{
    sink_start(sink, &start->window);
    const simulate_sink heard = {.self = sink,
                                 .requested = &sink->requested,
                                 .waits = sink->checkpointer->waits,
                                 .outputs = on_outputs,
                                 .event = on_event,
                                 .extremes = statistics_extremes(sink->statistics),
                                 .metrics = statistics_metrics(sink->statistics),
                                 .is_due = is_due,
                                 .serialize = serialize,
                                 .write_checkpoint = write_checkpoint,
                                 .resume = batch_checkpointer_resume(sink->checkpointer)};
    simulate(sink->checkpointer->of_case, &heard, &start->state, result);
}

/** Simulate with buffered outputs; if they show that an event was missed, repeat the simulation without buffer. The CPU
 *  time is that of both. */
static void simulate_to(batch_sink *sink, const batch_start *start, simulate_result *result)
{
    batch_checkpointer *checkpointer = sink->checkpointer;
    for (;;) {
        simulate_once(sink, start, result);
        const archive *from = batch_checkpointer_resume(checkpointer);
        const bool is_foreign = from != NULL && !archive_is_read(from);
        if (!is_foreign && result->end != SIMULATE_MISSED) {
            break;
        }
        if (is_foreign) {
            log_warning("case %ld restarts from time 0: %s", checkpointer->index, result->message);
            batch_checkpointer_begin_anew(checkpointer, true, 0);
        } else {
            batch_checkpointer_begin_anew(checkpointer, false, checkpointer->cpu_seconds + result->counts.cpu_seconds);
        }
        sink_end(sink);
    }
    result->counts.cpu_seconds += checkpointer->cpu_seconds;
}

static bool simulate_case(batch_checkpointer *checkpointer, const batch_start *start, batch_row *row, evl_error *error)
{
    const batch_plan *plan = checkpointer->plan;
    batch_sink sink = {.plan = plan, .checkpointer = checkpointer};
    simulate_result result;
    simulate_to(&sink, start, &result);
    bool good = result.end != SIMULATE_SINK_FAILED;
    if (good && result.end != SIMULATE_INTERRUPTED) {
        check_window(&sink, &result);
        conclude(&sink, &start->orbit, &result, row);
        row->has_checkpoints = checkpointer->has_some;
        good = sink.history == NULL ||
               stack_write(&plan->stack, (checkpointer->index - plan->first_case) / plan->stride, sink.history, error);
    }
    sink_end(&sink);
    return good;
}

/** Plan a case of a simulation and check everything except its start. */
static bool plan_simulation(const batch_plan *plan, long index, case_plan *of_case, metric_window *window,
                            evl_error *refusal)
{
    *window = (metric_window){.wheel = -1};
    return batch_plan_case(plan, index, of_case, refusal) && check_case(plan, of_case, window, refusal);
}

bool batch_case_check(const batch_plan *plan, long index, case_plan *of_case, evl_error *refusal)
{
    metric_window window;
    return plan->design->respond_over[0] != '\0'
               ? batch_response_check(plan, index, refusal)
               : plan_simulation(plan, index, of_case, &window, refusal) && case_start_check(of_case, refusal);
}

/** Row of a case that cannot start. @return false with the reason in `error` if the file of a wheel is invalid */
static bool refuse_case(const batch_plan *plan, long index, const evl_error *refusal, batch_row *row, evl_error *error)
{
    if (wheel_store_error(plan->wheels)->code != EVL_EXIT_OK) {
        *error = *wheel_store_error(plan->wheels);
        return false;
    }
    if (refusal->code != EVL_EXIT_INTERRUPTED) {
        CLEANUP_FREE char *message = evl_error_text(refusal);
        const bool is_failed = refusal->code == EVL_EXIT_INTEGRATION;
        batch_row_write(plan, index, is_failed ? JOURNAL_FAILED : JOURNAL_REFUSED, message, NULL, NULL, row);
    }
    return true;
}

bool batch_case_run(const batch_plan *plan, const batch_queue *queue, long index, case_plan *of_case, batch_row *row,
                    evl_error *error)
{
    evl_error refusal;
    batch_start start;
    batch_checkpointer checkpointer;
    *row = (batch_row){.line = NULL};
    if (plan->design->respond_over[0] != '\0') {
        return batch_response_check(plan, index, &refusal) ? batch_response_run(plan, queue, index, row, error)
                                                           : refuse_case(plan, index, &refusal, row, error);
    }
    if (!plan_simulation(plan, index, of_case, &start.window, &refusal) ||
        !case_start(of_case, batch_queue_stop_word(queue), &start.state, &start.orbit, &refusal)) {
        return refuse_case(plan, index, &refusal, row, error);
    }
    batch_checkpointer_begin(&checkpointer, plan, queue, index, of_case, error);
    const bool good = simulate_case(&checkpointer, &start, row, error);
    batch_checkpointer_end(&checkpointer);
    dae_state_free(&start.state);
    return good;
}
