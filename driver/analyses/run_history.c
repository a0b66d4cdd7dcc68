#include "analyses/run_history.h"

#include "analyses/versions.h"
#include "base/memory.h"
#include "integrate/integrate.h"
#include "model/model_start.h"
#include "simulate/metric_channel.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- start ---- */

/** Request the outputs of the case, and the constants. */
static void request_outputs(run_history *self)
{
    const case_plan *plan = self->plan;
    const model_facts *about = model_about(plan->model);
    requested_outputs_init(&self->requested, plan->model, &self->arena);
    for (int i = 0; i < plan->n_outputs; i++) {
        (void)requested_outputs_add(&self->requested, about->outputs[plan->outputs[i]].name);
    }
    self->n_output_values = self->requested.n_values;
    self->row = arena_calloc(&self->arena, (size_t)self->n_output_values + POSITIONS_OUTPUTS + (size_t)about->n_values,
                             sizeof *self->row);
    model_constants(plan->model, self->row + self->n_output_values + POSITIONS_OUTPUTS);
}

/** List the requested outputs, those of a position grid, and the constants, with their offsets in a row. */
static void list_outputs(run_history *self)
{
    const positions_rule *rule = &self->plan->positions;
    const model_facts *about = model_about(self->plan->model);
    model_output *all = arena_calloc(&self->arena, (size_t)about->n_outputs + POSITIONS_OUTPUTS, sizeof *all);
    int n = 0;
    for (int i = 0; i < about->n_outputs; i++) {
        const bool is_static = about->outputs[i].is_static;
        if (is_static || requested_outputs_has(&self->requested, i)) {
            all[n] = about->outputs[i];
            all[n++].offset = is_static ? self->n_output_values + POSITIONS_OUTPUTS + about->outputs[i].offset
                                        : self->requested.offsets[i];
        }
    }
    if (rule->per != NULL) {
        positions_describe(rule, self->n_output_values, &self->arena, all + n);
        n += POSITIONS_OUTPUTS;
    }
    self->layout.n_outputs = n;
    self->layout.outputs = all;
}

void run_history_init(run_history *self, const case_plan *plan, const model_start_orbit *start)
{
    const model *model = plan->model;
    const model_facts *about = model_about(model);
    *self = (run_history){.plan = plan, .start = start};
    request_outputs(self);
    CLEANUP_FREE model_state *states = model_states(model);
    model_state *own_states = arena_calloc(&self->arena, (size_t)about->dae.n, sizeof *own_states);
    memcpy(own_states, states, (size_t)about->dae.n * sizeof *own_states);
    self->layout = (history_layout){
        .kind = "history",
        .axis = {.name = "time", .units = "s", .symbol = "t", .long_name = "model time"},
        .names = &about->names,
        .n_harmonics = plan->description->simulation.metrics.is_set ? METRIC_HARMONICS : 0,
        .n_all = about->n_outputs,
        .all = about->outputs,
        .n_states = about->dae.n,
        .states = own_states,
        .n_event_kinds = model_tables()->n_event_kinds,
        .event_kinds = model_tables()->event_kinds,
        .max_rows = output_grid_size(&plan->integration, 0),
    };
    list_outputs(self);
}

void run_history_monitor(run_history *self)
{
    const case_plan *plan = self->plan;
    extremes_delete(&self->extremes);
    metrics_delete(&self->metrics);
    if (plan->description->simulation.metrics.is_set) {
        bool all[N_METRIC_ROWS];
        memset(all, true, sizeof all);
        self->metrics = metrics_create(plan->model, &plan->window, all);
    }
    self->extremes = extremes_create(plan->model, plan->description->n_meshes, -INFINITY, INFINITY);
}

static void simulate_once(run_history *self, simulate_sink *sink, const dae_state *start, simulate_result *result)
{
    run_history_monitor(self);
    sink->requested = &self->requested;
    sink->extremes = self->extremes;
    sink->metrics = self->metrics;
    simulate(self->plan, sink, start, result);
}

void run_history_simulate(run_history *self, simulate_sink *sink, const dae_state *start, bool (*again)(void *self),
                          simulate_result *result)
{
    sink->waits = true;
    simulate_once(self, sink, start, result);
    if (result->end != SIMULATE_MISSED) {
        return;
    }
    if (again == NULL) {
        run_history_again(self);
    } else if (!again(sink->self)) {
        result->end = SIMULATE_SINK_FAILED;
        return;
    }
    sink->waits = false;
    simulate_once(self, sink, start, result);
}

static void add_attributes(history_attribute *all, int *n, size_t n_more, const history_attribute *more)
{
    memcpy(all + *n, more, n_more * sizeof *more);
    *n += (int)n_more;
}

bool run_history_open(run_history *self, const char *path, evl_error *error)
{
    const case_plan *plan = self->plan;
    const positions_rule *rule = &plan->positions;
    const model_start_orbit *orbit = self->start;
    CLEANUP_FREE char *warnings = case_plan_warnings(plan, orbit, "\n");
    CLEANUP_FREE char *versions = result_versions();
    const history_attribute always[] = {
        {"title", .text = plan->description->title},
        {"case", .text = case_text(plan->file)},
        {"versions", .text = versions},
        {"warnings", .text = warnings},
        {"status", .text = "running"},
        {"status_message", .text = ""},
        {"integrator_tolerance", .number = plan->integration.tolerance},
    };
    const history_attribute of_positions[] = {
        {"output_per", .text = rule->per},
        {"output_number", .integer = rule->number},
        {"output_of", .text = rule->of},
    };
    const history_attribute of_orbit[] = {
        {"start_period", .number = orbit->time},
        {"start_pitches", .integer = orbit->pitches},
        {"start_residual", .number = orbit->residual},
        {"start_multiplier", .number = model_start_multiplier(orbit)},
    };
    history_attribute attributes[sizeof always / sizeof *always + sizeof of_positions / sizeof *of_positions +
                                 sizeof of_orbit / sizeof *of_orbit];
    int n = 0;
    add_attributes(attributes, &n, sizeof always / sizeof *always, always);
    add_attributes(attributes, &n, rule->per == NULL ? 0 : sizeof of_positions / sizeof *of_positions, of_positions);
    add_attributes(attributes, &n, orbit->pitches == 0 ? 0 : sizeof of_orbit / sizeof *of_orbit, of_orbit);
    history_layout layout = self->layout;
    layout.path = path;
    layout.n_attributes = n;
    layout.attributes = attributes;
    self->history = history_create(&layout, error);
    if (self->history != NULL) {
        history_put_statics(self->history, self->row);
    }
    return self->history != NULL;
}

/* ---- outputs of the simulation ---- */

void run_history_again(run_history *self)
{
    self->rows.to_come = self->rows.written;
    self->events.to_come = self->events.written;
}

/** Whether the next one is already on file. */
static bool is_written(run_history_count *count)
{
    if (count->to_come > 0) {
        count->to_come--;
        return true;
    }
    count->written++;
    return false;
}

/** Time k of a block as a row. */
static const double *row_of(const run_history *self, const output_block *block, int k)
{
    for (int i = 0; i < self->n_output_values; i++) {
        self->row[i] = output_values(block, i)[k];
    }
    if (block->marks != NULL) {
        self->row[self->n_output_values + POSITIONS_VALUE] = block->marks[k].position;
        self->row[self->n_output_values + POSITIONS_KIND] = block->marks[k].kind;
    }
    return self->row;
}

bool run_history_outputs(run_history *self, const output_block *block, evl_error *error)
{
    if (block->marks == NULL && self->rows.to_come == 0) { /* without conversion */
        self->rows.written += block->n;
        return history_append_rows(self->history, block->n, block->t, block->values, DAE_LANES, error);
    }
    bool good = true;
    for (int k = 0; k < block->n && good; k++) {
        good = is_written(&self->rows) || history_append(self->history, block->t[k], row_of(self, block, k), error);
    }
    return good;
}

bool run_history_event(run_history *self, const event_record *record, evl_error *error)
{
    const dae_event *what = &record->what;
    const history_event event = {.t = record->t,
                                 .kind = what->kind,
                                 .mesh = what->subject,
                                 .flank = what->side,
                                 .tooth_pair = what->count,
                                 .before = record->before->y,
                                 .after = record->after->y};
    return is_written(&self->events) || history_add_event(self->history, &event, error);
}

/* ---- end ---- */

/** Write the extremes over the run, as variables of the meshes. */
static bool put_extremes(const run_history *self, evl_error *error)
{
    const int n = model_tables()->n_extremes, n_meshes = self->plan->description->n_meshes;
    CLEANUP_FREE model_output *outputs = xcalloc(2 * (size_t)n, sizeof *outputs);
    CLEANUP_FREE double *values = xcalloc(2 * (size_t)n * (size_t)n_meshes, sizeof *values);
    for (int i = 0; i < 2 * n; i++) {
        const model_extreme *row = &model_tables()->extremes[i / 2];
        outputs[i] = i % 2 == 0 ? row->value : row->time;
        outputs[i].count = n_meshes;
        outputs[i].offset = i * n_meshes;
        for (int mesh = 0; mesh < n_meshes; mesh++) {
            const extreme_found extreme = extremes_found(self->extremes, i / 2, mesh);
            values[outputs[i].offset + mesh] = i % 2 == 0 ? extreme.value : extreme.time;
        }
    }
    return history_put_finals(self->history, 2 * n, outputs, values, error);
}

/** Write the metrics of the case, as variables with the prefix window_. */
static bool put_metrics(const run_history *self, evl_error *error)
{
    const model_names *names = &model_about(self->plan->model)->names;
    ARENA_SCOPE memory_arena arena = {NULL};
    model_output rows[N_METRIC_ROWS];
    const int n = metric_rows_lay_out(names, rows);
    CLEANUP_FREE double *values = xcalloc((size_t)n, sizeof *values);
    metrics_conclude(self->metrics, values);
    int n_rows = 0;
    for (int i = 0; i < N_METRIC_ROWS; i++) {
        if (metric_row_exists(self->plan->model, i)) {
            rows[n_rows] = rows[i];
            rows[n_rows++].name = arena_printf(&arena, "window_%s", rows[i].name);
        }
    }
    const metric_span span = metrics_span(self->metrics);
    const double of_span[] = {span.from, span.to, (double)span.periods, metrics_settled(self->metrics)->is_settled};
    const model_output rows_of_span[] = {
        {"window_begin", "s", "", "start of the first whole period of the metrics", "", true, false, 0, 1, NULL},
        {"window_end", "s", "", "end of the last whole period of the metrics", "", true, false, 1, 1, NULL},
        {"window_periods", "1", "", "whole periods of the metrics", "", true, true, 2, 1, NULL},
        {"window_settled", "1", "", "1 if the motion had settled before the window, 0 if not; NaN: unknown", "", true,
         false, 3, 1, NULL},
    };
    return history_put_finals(self->history, 4, rows_of_span, of_span, error) &&
           history_put_finals(self->history, n_rows, rows, values, error);
}

bool run_history_put(const run_history *self, evl_error *error)
{
    return put_extremes(self, error) && (self->metrics == NULL || put_metrics(self, error));
}

/** Attributes about the end of the run. @return the status */
static const char *describe_end(const simulate_result *result, const char *who, char message[2 * DAE_MESSAGE_LENGTH])
{
    const size_t size = 2 * (size_t)DAE_MESSAGE_LENGTH;
    if (result->end == SIMULATE_INTERRUPTED) {
        (void)snprintf(message, size, "interrupted by %s at t = %.9g s", who, result->t);
        return "interrupted";
    }
    if (result->end == SIMULATE_FAILED) {
        (void)snprintf(message, size, "failed at t = %.9g s: %s", result->t, result->message);
        return "failed";
    }
    (void)snprintf(message, size, "%s", result->remark);
    return "done";
}

bool run_history_close(run_history *self, const char *who, const simulate_result *result, const char *checkpoints,
                       evl_error *error)
{
    char message[2 * DAE_MESSAGE_LENGTH];
    const char *status = describe_end(result, who, message);
    const integrate_counts *counts = &result->counts;
    const bool by_stepper = self->plan->integration.by_stepper;
    enum { MOST_ATTRIBUTES = 14 };
    history_attribute attributes[MOST_ATTRIBUTES] = {
        {"status", .text = status},
        {"status_message", .text = message},
        {"invariants", .text = result->invariants},
        {"integrator_steps", .integer = counts->steps},
        {"integrator_residuals", .integer = counts->residuals},
        {"integrator_jacobians", .integer = counts->jacobians},
        {"integrator_linear_setups", .integer = counts->linear_setups},
        {"integrator_newton_iterations", .integer = counts->newton_iterations},
        {"integrator_root_evaluations", .integer = counts->roots_evaluated},
        {"integrator_events", .integer = counts->events},
        by_stepper ? (history_attribute){"integrator_rejections", .integer = counts->rejections}
                   : (history_attribute){"integrator_error_test_failures", .integer = counts->error_test_failures},
        {"integrator_convergence_failures", .integer = counts->convergence_failures},
    };
    int n = by_stepper ? 11 : 12;
    if (!by_stepper && checkpoints[0] != '\0') {
        attributes[n++] = (history_attribute){"checkpoints", .text = checkpoints};
    }
    if (self->metrics != NULL) {
        attributes[n++] = (history_attribute){"window_settled_reason", .text = metrics_settled(self->metrics)->reason};
    }
    return history_close(&self->history, result->end == SIMULATE_DONE, n, attributes, error);
}

void run_history_abandon(run_history *self)
{
    history_abandon(&self->history);
}

const char *run_history_partial_path(const run_history *self)
{
    return history_partial_path(self->history);
}

void run_history_free(run_history *self)
{
    extremes_delete(&self->extremes);
    metrics_delete(&self->metrics);
    arena_free(&self->arena);
}
