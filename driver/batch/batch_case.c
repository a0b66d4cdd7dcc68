#include "batch/batch_case.h"

#include "base/json.h"
#include "base/log.h"
#include "base/memory.h"
#include "base/words.h"
#include "batch/batch_keeper.h"
#include "batch/batch_response.h"
#include "model/model_start.h"
#include "simulate/simulate.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

/** Start of a case. */
typedef struct {
    dae_state state; /**< at t = 0; to be freed */
    number_window window;
} batch_start;

typedef struct {
    const batch_plan *plan;
    memory_pool pool;
    wanted_outputs wanted;
    statistics *statistics;
    float *history; /**< a row of the stack; NULL if there are no histories */
    int *places;    /**< of the history's variables among the outputs; -1: the time */
    long n_outputs; /**< so far */
    batch_keeper *keeper;
} batch_sink;

void batch_case_lost(const batch_plan *plan, long index, const char *message, batch_row *row)
{
    batch_row_write(plan, index, JOURNAL_FAILED, message, NULL, NULL, row);
}

/* ---- checks of a case ---- */

/** Window of a case: the design's times, or the case's own. @return false if it contains no output */
static bool find_window(const batch_plan *plan, const prepared_case *prepared, number_window *window)
{
    const numbers_description *own = &case_description(prepared->file)->simulation.numbers;
    const integrate_options options = simulate_options(prepared);
    const double *given = plan->design->window, dt = options.output_interval, slack = 1e-6;
    *window = (number_window){.from = isnan(given[0]) ? own->from : given[0],
                              .to = isnan(given[1]) ? own->to : given[1],
                              .mesh = own->mesh,
                              .wheel = own->wheel};
    if (options.per_unit > 0) { /* output times are not known in advance */
        return window->from <= options.t_end;
    }
    const double first = ceil(window->from / dt - slack) * dt; /* on the grid */
    const bool has_grid_point = first <= fmin(window->to, options.t_end) + slack * dt;
    const bool has_end = window->from <= options.t_end && options.t_end <= window->to;
    return has_grid_point || has_end;
}

static bool has_history_shape(const batch_plan *plan, const prepared_case *prepared)
{
    const batch_histories *histories = &plan->histories;
    bool good = batch_axis_fits(&histories->axis, prepared);
    for (int i = 0; i < histories->n_variables && good; i++) {
        const model_output *wanted = &histories->variables[i];
        const model_output *output = model_output_named(prepared->model, wanted->name);
        good = wanted->offset < 0 || (output != NULL && output->count == wanted->count);
    }
    return good;
}

/** @return false with the reason in `refusal` */
static bool check_case(const batch_plan *plan, const prepared_case *prepared, number_window *window, evl_error *refusal)
{
    const integrate_options options = simulate_options(prepared);
    const int n_meshes = case_description(prepared->file)->n_meshes;
    const char *place = case_path(prepared->file);
    if (n_meshes != plan->table.n_meshes) {
        return evl_error_set(
            refusal, EVL_EXIT_CASE, place,
            "the number of meshes is %d, that of the base case %d; all cases of a design have the same meshes",
            n_meshes, plan->table.n_meshes);
    }
    const description *description = case_description(prepared->file);
    if (plan->table.n_numbers > 0 && (description->n_wheels != plan->table.names.wheels.n ||
                                      description->n_accelerometers != plan->table.names.accelerometers.n)) {
        return evl_error_set(refusal, EVL_EXIT_CASE, place,
                             "has %d wheels and %d accelerometers, the base case %d and %d; with metrics over whole "
                             "periods all cases need the same",
                             description->n_wheels, description->n_accelerometers, plan->table.names.wheels.n,
                             plan->table.names.accelerometers.n);
    }
    if (!find_window(plan, prepared, window)) {
        return evl_error_set(refusal, EVL_EXIT_CASE, place,
                             "the window from %g to %g s contains no output of this case, which ends at %g s",
                             window->from, window->to, options.t_end);
    }
    return plan->histories.n_variables == 0 || has_history_shape(plan, prepared) ||
           evl_error_set(refusal, EVL_EXIT_CASE, place,
                         "its history differs in times, positions or sizes from those of the other cases; plan it "
                         "without histories");
}

/* ---- outputs of the simulation ---- */

/** Store one output of a stacked history, if it is on the axis; of several at one position the first. */
static void keep_output(const batch_sink *sink, const output_block *block, int time)
{
    const batch_histories *histories = &sink->plan->histories;
    const output_mark *mark = block->marks == NULL ? NULL : &block->marks[time];
    const long k = batch_axis_place(&histories->axis, sink->n_outputs, block->t[time], mark);
    float *to = sink->history;
    if (k < 0 || (histories->axis.rule.per != NULL && !isnan(to[k]))) {
        return;
    }
    for (int i = 0; i < histories->n_variables; i++) {
        const int count = histories->variables[i].count, place = sink->places[i];
        for (int j = 0; j < count; j++) {
            to[k * count + j] = (float)(place < 0 ? block->t[time] : output_values(block, place + j)[time]);
        }
        to += (long)histories->axis.coordinate.n * count;
    }
}

static bool on_outputs(void *self, const output_block *block)
{
    batch_sink *sink = self;
    statistics_outputs(sink->statistics, block);
    for (int k = 0; k < block->n && sink->history != NULL; k++) {
        keep_output(sink, block, k);
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
    return batch_keeper_is_due(sink->keeper);
}

/** Serialise what the simulation does not. */
static void keep(void *self, archive *archive)
{
    batch_sink *sink = self;
    statistics_keep(sink->statistics, archive);
    KEEP(archive, sink->n_outputs);
    if (sink->history != NULL) {
        KEEP_ARRAY(archive, sink->history, stack_row_length(&sink->plan->stack));
    }
}

static simulate_kept kept(void *self, double t, const archive *archive)
{
    const batch_sink *sink = self;
    return batch_keeper_kept(sink->keeper, t, archive);
}

static void start_history(batch_sink *sink)
{
    const batch_histories *histories = &sink->plan->histories;
    if (histories->n_variables == 0) {
        return;
    }
    const long n = stack_row_length(&sink->plan->stack);
    sink->history = pool_calloc(&sink->pool, (size_t)n, sizeof *sink->history);
    sink->places = pool_calloc(&sink->pool, (size_t)histories->n_variables, sizeof *sink->places);
    for (long i = 0; i < n; i++) {
        sink->history[i] = NAN;
    }
    for (int i = 0; i < histories->n_variables; i++) {
        sink->places[i] = wanted_add(&sink->wanted, histories->variables[i].name);
    }
}

/* ---- the case ---- */

/** Warnings of `evolvent run`, except those of the base case's own numbers, which are printed once. */
static char *remarks(const prepared_case *prepared, const char *remark)
{
    OWNED char *warnings = prepare_own_warnings(prepared, "; ");
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

static void conclude(const batch_sink *sink, const prepared_case *prepared, long index, const simulate_result *result,
                     batch_row *row)
{
    const batch_plan *plan = sink->plan;
    const bool is_done = result->end == SIMULATE_DONE;
    OWNED double *results = xcalloc((size_t)plan->table.n, sizeof *results);
    const model_start_orbit *orbit = model_orbit_of_start(prepared->model);
    statistics_finish(sink->statistics, result, orbit == NULL ? NAN : model_start_multiplier(orbit), results);
    OWNED char *invariants = result->held ? xstrdup("") : xasprintf("its own invariants are %s", result->invariants);
    const numbers *numbers = statistics_numbers(sink->statistics);
    const char *unsettled = numbers == NULL ? "" : numbers_settled(numbers)->reason;
    OWNED char *window = unsettled[0] == '\0' ? xstrdup("") : xasprintf("the window may not be settled: %s", unsettled);
    const char *const all[] = {result->remark, window, invariants};
    const char *told[3];
    int n_told = 0;
    for (int i = 0; i < 3; i++) {
        if (all[i][0] != '\0') {
            told[n_told++] = all[i];
        }
    }
    OWNED char *remark = words_join(n_told, told, "; ");
    OWNED char *message =
        is_done ? remarks(prepared, remark) : xasprintf("failed at t = %.9g s: %s", result->t, result->message);
    batch_row_write(plan, index, is_done ? JOURNAL_DONE : JOURNAL_FAILED, message, results, sink->history, row);
}

static void sink_start(batch_sink *sink, const prepared_case *prepared, const number_window *window)
{
    const batch_plan *plan = sink->plan;
    const double interval = case_description(prepared->file)->simulation.output_interval; /* by position: 0 */
    *sink = (batch_sink){.plan = plan, .keeper = sink->keeper};
    wanted_init(&sink->wanted, prepared->model, &sink->pool);
    sink->statistics = statistics_create(&plan->table, &sink->wanted, window, interval);
    start_history(sink);
}

static void sink_end(batch_sink *sink)
{
    statistics_delete(&sink->statistics);
    pool_free(&sink->pool);
}

static void simulate_once(batch_sink *sink, const prepared_case *prepared, const batch_start *start,
                          simulate_result *result)
{
    const dae *dae = &model_about(prepared->model)->dae;
    POOLED memory_pool pool = {NULL};
    dae_state state = dae_state_create(dae, &pool);
    dae_state_copy(dae, &state, &start->state);
    sink_start(sink, prepared, &start->window);
    const simulate_sink heard = {.self = sink,
                                 .wanted = &sink->wanted,
                                 .waits = sink->keeper->waits,
                                 .outputs = on_outputs,
                                 .event = on_event,
                                 .extremes = statistics_extremes(sink->statistics),
                                 .numbers = statistics_numbers(sink->statistics),
                                 .is_due = is_due,
                                 .keep = keep,
                                 .kept = kept,
                                 .resume = batch_keeper_resume(sink->keeper)};
    simulate(prepared, &heard, &state, result);
}

/** Simulate with buffered outputs; if they show that an event was missed, repeat the simulation without buffer. The CPU
 *  time is that of both. */
static void simulate_to(batch_sink *sink, const prepared_case *prepared, const batch_start *start,
                        simulate_result *result)
{
    batch_keeper *keeper = sink->keeper;
    for (;;) {
        simulate_once(sink, prepared, start, result);
        const archive *from = batch_keeper_resume(keeper);
        const bool is_foreign = from != NULL && !archive_is_read(from);
        if (!is_foreign && result->end != SIMULATE_MISSED) {
            break;
        }
        if (is_foreign) {
            log_warning("case %ld restarts from time 0: %s", keeper->index, result->message);
            batch_keeper_begin_anew(keeper, true, 0);
        } else {
            batch_keeper_begin_anew(keeper, false, keeper->cpu_seconds + result->counts.cpu_seconds);
        }
        sink_end(sink);
    }
    result->counts.cpu_seconds += keeper->cpu_seconds;
}

static bool simulate_prepared(batch_keeper *keeper, const batch_start *start, batch_row *row, evl_error *error)
{
    const batch_plan *plan = keeper->plan;
    batch_sink sink = {.plan = plan, .keeper = keeper};
    simulate_result result;
    simulate_to(&sink, keeper->prepared, start, &result);
    bool good = result.end != SIMULATE_SINK_FAILED;
    if (good && result.end != SIMULATE_INTERRUPTED) {
        check_window(&sink, &result);
        conclude(&sink, keeper->prepared, keeper->index, &result, row);
        row->has_checkpoints = keeper->has_some;
        good = sink.history == NULL ||
               stack_write(&plan->stack, (keeper->index - plan->first_case) / plan->stride, sink.history, error);
    }
    sink_end(&sink);
    return good;
}

/** Prepare a case of a simulation and check everything except its start. */
static bool prepare_simulation(const batch_plan *plan, long index, prepared_case *prepared, number_window *window,
                               evl_error *refusal)
{
    *window = (number_window){.wheel = -1};
    return batch_prepare(plan, index, prepared, refusal) && check_case(plan, prepared, window, refusal);
}

bool batch_case_check(const batch_plan *plan, long index, prepared_case *prepared, evl_error *refusal)
{
    number_window window;
    return plan->design->respond_over[0] != '\0'
               ? batch_response_check(plan, index, refusal)
               : prepare_simulation(plan, index, prepared, &window, refusal) && prepare_check_start(prepared, refusal);
}

/** Row of a case that cannot start. @return false with the reason in `error` if the file of a wheel is invalid */
static bool refuse_case(const batch_plan *plan, long index, const evl_error *refusal, batch_row *row, evl_error *error)
{
    if (wheel_store_error(plan->wheels)->code != EVL_EXIT_OK) {
        *error = *wheel_store_error(plan->wheels);
        return false;
    }
    if (refusal->code != EVL_EXIT_INTERRUPTED) {
        OWNED char *message = evl_error_text(refusal);
        const bool is_failed = refusal->code == EVL_EXIT_INTEGRATION;
        batch_row_write(plan, index, is_failed ? JOURNAL_FAILED : JOURNAL_REFUSED, message, NULL, NULL, row);
    }
    return true;
}

bool batch_case_run(const batch_plan *plan, const batch_queue *queue, long index, prepared_case *prepared,
                    batch_row *row, evl_error *error)
{
    evl_error refusal;
    batch_start start;
    batch_keeper keeper;
    *row = (batch_row){.line = NULL};
    if (plan->design->respond_over[0] != '\0') {
        return batch_response_check(plan, index, &refusal) ? batch_response_run(plan, queue, index, row, error)
                                                           : refuse_case(plan, index, &refusal, row, error);
    }
    if (!prepare_simulation(plan, index, prepared, &start.window, &refusal) ||
        !prepare_start_unless(prepared, batch_queue_stop_word(queue), &start.state, &refusal)) {
        return refuse_case(plan, index, &refusal, row, error);
    }
    batch_keeper_begin(&keeper, plan, queue, index, prepared, error);
    const bool good = simulate_prepared(&keeper, &start, row, error);
    batch_keeper_end(&keeper);
    dae_state_free(&start.state);
    return good;
}
