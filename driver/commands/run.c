#include "base/interrupt.h"
#include "base/log.h"
#include "base/memory.h"
#include "base/progress.h"
#include "commands/command.h"
#include "commands/result.h"
#include "commands/run_numbers.h"
#include "commands/show_geometry.h"
#include "commands/warn.h"
#include "files/history.h"
#include "integrate/integrate.h"
#include "integrate/integrate_types.h"
#include "model/output_groups.h"
#include "simulate/extremes.h"
#include "simulate/positions.h"
#include "simulate/simulate.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

typedef struct {
    const char *output;  /**< NULL: the case's name with .h5 in the current folder */
    const char *outputs; /**< names of variables and groups; NULL: as the case says */
    option_values set;
    bool quiet;
} run_options;

typedef struct {
    prepared_case prepared;
    memory_pool pool; /**< of the outputs */
    wanted_outputs wanted;
    int n_told;  /**< values of the outputs */
    double *row; /**< values of the outputs, of those of a grid of positions, constants that are not told */
    history *history;
    extremes *extremes;
    numbers *numbers; /**< NULL: the case does not ask for them */
    progress progress;
    evl_error *error;
} run;

/* What the simulation tells. */

/** Time k of a block as a row. */
static const double *row_of(const run *run, const output_block *block, int k)
{
    if (run->wanted.all && block->marks == NULL) {
        return block->values; /* all outputs, the constants among them */
    }
    for (int i = 0; i < run->n_told; i++) {
        run->row[i] = output_values(block, i)[k];
    }
    if (block->marks != NULL) {
        run->row[run->n_told + POSITIONS_PLACE] = block->marks[k].position;
        run->row[run->n_told + POSITIONS_KIND] = block->marks[k].kind;
    }
    return run->row;
}

static bool on_outputs(void *self, const output_block *block)
{
    const run *run = self;
    bool good = true;
    for (int k = 0; k < block->n && good; k++) {
        good = history_append(run->history, block->t[k], row_of(run, block, k), run->error);
    }
    return good;
}

static bool on_event(void *self, const event_record *record)
{
    const run *run = self;
    const dae_event *what = &record->what;
    const history_event event = {.t = record->t,
                                 .kind = what->kind,
                                 .mesh = what->subject,
                                 .flank = what->side,
                                 .tooth_pair = what->count,
                                 .before = record->before->y,
                                 .after = record->after->y};
    return history_add_event(run->history, &event, run->error);
}

static void on_step(void *self, double t)
{
    run *run = self;
    progress_step(&run->progress, t);
}

/* The history's head and end. */

/** What the case asks for: all, or some of them, and the constants. */
static void want_outputs(run *run)
{
    const model *model = run->prepared.model;
    const model_facts *about = model_about(model);
    const char *words = case_description(run->prepared.file)->simulation.outputs;
    OWNED bool *chosen = xcalloc((size_t)about->n_outputs, sizeof *chosen);
    bool all = true;
    if (words != NULL) {
        free(output_groups_choose(words, about->n_outputs, about->outputs, chosen)); /* the case was checked */
    }
    for (int i = 0; i < about->n_outputs && words != NULL; i++) {
        all = all && (chosen[i] || about->outputs[i].is_static);
    }
    wanted_init(&run->wanted, model, all, &run->pool);
    for (int i = 0; i < about->n_outputs && !all; i++) {
        if (chosen[i]) {
            (void)wanted_add(&run->wanted, about->outputs[i].name);
        }
    }
    run->n_told = run->wanted.n_values;
    run->row =
        pool_calloc(&run->pool, (size_t)run->n_told + POSITIONS_OUTPUTS + (size_t)about->n_values, sizeof *run->row);
    model_constants(model, run->row + run->n_told + POSITIONS_OUTPUTS);
}

/** The outputs that are told, those of a grid of positions, and the constants, with their places in a row. */
static int list_outputs(run *run, const positions_rule *rule, const model_output **outputs)
{
    const model_facts *about = model_about(run->prepared.model);
    model_output *all = pool_calloc(&run->pool, (size_t)about->n_outputs + POSITIONS_OUTPUTS, sizeof *all);
    int n = 0;
    for (int i = 0; i < about->n_outputs; i++) {
        const bool is_static = about->outputs[i].is_static;
        if (is_static || wanted_has(&run->wanted, i)) {
            /* of all outputs the constants are told with them */
            const int behind = run->wanted.all ? 0 : run->n_told + POSITIONS_OUTPUTS;
            all[n] = about->outputs[i];
            all[n++].offset = is_static ? behind + about->outputs[i].offset : run->wanted.places[i];
        }
    }
    if (rule->per != NULL) {
        positions_describe(rule, run->n_told, &run->pool, all + n);
        n += POSITIONS_OUTPUTS;
    }
    *outputs = all;
    return n;
}

static bool create_history(run *run, const char *path)
{
    const model *model = run->prepared.model;
    const description *description = case_description(run->prepared.file);
    const integrate_options options = simulate_options(&run->prepared);
    const positions_rule rule = positions_of(&run->prepared);
    const model_output *outputs = NULL;
    const int n_outputs = list_outputs(run, &rule, &outputs);
    OWNED model_state *states = model_states(model);
    OWNED char *warnings = prepare_warnings(&run->prepared, "\n");
    OWNED char *versions = result_versions();
    const history_attribute attributes[] = {
        {"title", .text = description->title},
        {"case", .text = case_text(run->prepared.file)},
        {"versions", .text = versions},
        {"warnings", .text = warnings},
        {"status", .text = "running"},
        {"status_message", .text = ""},
        {"integrator_tolerance", .number = options.tolerance},
        {"output_per", .text = rule.per},
        {"output_number", .integer = rule.number},
        {"output_of", .text = rule.of},
    };
    const int n_attributes = (int)(sizeof attributes / sizeof *attributes) - (rule.per == NULL ? 3 : 0);
    const history_layout layout = {
        .path = path,
        .kind = "history",
        .axis = {.name = "time", .units = "s", .symbol = "t", .long_name = "model time"},
        .names = &model_about(model)->names,
        .n_harmonics = description->simulation.numbers.is_given ? NUMBER_HARMONICS : 0,
        .n_outputs = n_outputs,
        .outputs = outputs,
        .n_all = model_about(model)->n_outputs,
        .all = model_about(model)->outputs,
        .n_states = model_about(model)->dae.n,
        .states = states,
        .n_event_kinds = model_tables()->n_event_kinds,
        .event_kinds = model_tables()->event_kinds,
        .max_rows = output_grid_size(&options, 0),
        .n_attributes = n_attributes,
        .attributes = attributes,
    };
    run->history = history_create(&layout, run->error);
    return run->history != NULL;
}

/** The extremes over the run, as variables of the meshes. */
static bool put_extremes(const run *run)
{
    const int n = model_tables()->n_extremes, n_meshes = case_description(run->prepared.file)->n_meshes;
    OWNED model_output *outputs = xcalloc(2 * (size_t)n, sizeof *outputs);
    OWNED double *values = xcalloc(2 * (size_t)n * (size_t)n_meshes, sizeof *values);
    for (int i = 0; i < 2 * n; i++) {
        const model_extreme *extreme = &model_tables()->extremes[i / 2];
        outputs[i] = i % 2 == 0 ? extreme->value : extreme->time;
        outputs[i].count = n_meshes;
        outputs[i].offset = i * n_meshes;
        for (int mesh = 0; mesh < n_meshes; mesh++) {
            const extreme_found found = extremes_found(run->extremes, i / 2, mesh);
            values[outputs[i].offset + mesh] = i % 2 == 0 ? found.value : found.time;
        }
    }
    return history_put_finals(run->history, 2 * n, outputs, values, run->error);
}

/** The numbers of the case, as variables with window_ in front; and those that tell most, in words. */
static bool put_numbers(const run *run)
{
    const model_names *names = &model_about(run->prepared.model)->names;
    POOLED memory_pool pool = {NULL};
    model_output rows[N_NUMBER_ROWS];
    const int n = number_rows_place(&pool, names, rows);
    OWNED double *values = xcalloc((size_t)n, sizeof *values);
    numbers_conclude(run->numbers, values);
    tell_numbers(run->numbers, names, rows, values);
    for (int i = 0; i < N_NUMBER_ROWS; i++) {
        rows[i].name = pool_printf(&pool, "window_%s", rows[i].name);
    }
    const number_span span = numbers_span(run->numbers);
    const double of_span[] = {span.from, span.to, (double)span.periods};
    const model_output rows_of_span[] = {
        {"window_begin", "s", "", "where the first whole period of the numbers begins", "", true, false, 0, 1},
        {"window_end", "s", "", "where the last one ends", "", true, false, 1, 1},
        {"window_periods", "1", "", "whole periods of the numbers", "", true, true, 2, 1},
    };
    return history_put_finals(run->history, 3, rows_of_span, of_span, run->error) &&
           history_put_finals(run->history, N_NUMBER_ROWS, rows, values, run->error);
}

static bool close_history(run *run, bool commit, const char *status, const char *message, const simulate_result *result)
{
    const integrate_counts *counts = &result->counts;
    const bool by_stepper = simulate_options(&run->prepared).by_stepper;
    const history_attribute attributes[] = {
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
    const int n = (int)(sizeof attributes / sizeof *attributes) - (by_stepper ? 1 : 0);
    return history_close(&run->history, commit, n, attributes, run->error);
}

/* The run itself. */

/** What the meshes' stiffness and damping come to. */
static void tell_vibrations(const run *run)
{
    const description *description = case_description(run->prepared.file);
    for (int i = 0; i < description->n_meshes; i++) {
        const model *model = run->prepared.model;
        const double ratio = model_quantity(model, EVL_OF_MESH, i, "damping_ratio");
        if (!isnan(ratio)) {
            log_note("mesh %s at %.5g N, one tooth pair: natural frequency %.5g Hz, damping ratio %.3g",
                     description->meshes[i], model_quantity(model, EVL_OF_MESH, i, "reference_force"),
                     model_quantity(model, EVL_OF_MESH, i, "natural_frequency"), ratio);
        }
    }
    OWNED char *note = stiffness_note(description, run->prepared.model);
    if (note[0] != '\0') {
        log_note("%s", note);
    }
}

static void summarise(const integrate_counts *counts, const char *path)
{
    log_note("%ld steps, %ld event%s, %.3g s CPU: %s", counts->steps, counts->events, counts->events == 1 ? "" : "s",
             (double)clock() / CLOCKS_PER_SEC, path);
}

/** The last line of a run that cannot be trusted. */
static void warn_of_invariants(const run *run, const simulate_result *result)
{
    const bool is_stated = case_description(run->prepared.file)->simulation.accuracy > 0;
    if (!result->held) {
        log_warning("the run's own invariants are %s: lower simulation.%s, or give a smaller simulation.max_step",
                    result->invariants, is_stated ? "accuracy" : "tolerance");
    }
}

/** The run ended: complete the history, and say how it went. */
static void conclude(run *run, const simulate_result *result, const char *path)
{
    char reason[2 * DAE_MESSAGE_LENGTH] = "";
    const char *status = "done", *remark = result->remark;
    OWNED char *partial = xstrdup(history_partial_path(run->history));
    OWNED char *place = xasprintf("%s: t = %.9g s", case_path(run->prepared.file), result->t);
    if (remark[0] != '\0') {
        log_warning("%s", remark);
    }
    if (result->end == SIMULATE_INTERRUPTED) {
        status = "interrupted";
        (void)snprintf(reason, sizeof reason, "interrupted by %s at t = %.9g s", interrupt_name((int)interrupt_signal),
                       result->t);
        evl_error_set(run->error, EVL_EXIT_INTERRUPTED, place, "interrupted by %s; the history up to there is in '%s'",
                      interrupt_name((int)interrupt_signal), partial);
    } else if (result->end == SIMULATE_FAILED) {
        status = "failed";
        (void)snprintf(reason, sizeof reason, "failed at t = %.9g s: %s", result->t, result->message);
        evl_error_set(run->error, EVL_EXIT_INTEGRATION, place, "%s; the history up to there is in '%s'",
                      result->message, partial);
    }
    const bool is_done = result->end == SIMULATE_DONE;
    if (close_history(run, is_done, status, is_done ? remark : reason, result) && is_done) {
        summarise(&result->counts, path);
        warn_of_invariants(run, result);
    }
}

static void simulate_case(run *run, const char *path, dae_state *state)
{
    simulate_result result;
    const numbers_description *asked = &case_description(run->prepared.file)->simulation.numbers;
    if (asked->is_given) {
        bool all[N_NUMBER_ROWS];
        memset(all, true, sizeof all);
        const number_window window = {asked->from, asked->to, asked->mesh, asked->wheel};
        run->numbers = numbers_create(run->prepared.model, &window, all);
    }
    run->extremes =
        extremes_create(run->prepared.model, case_description(run->prepared.file)->n_meshes, -INFINITY, INFINITY);
    const simulate_sink sink = {.self = run,
                                .wanted = &run->wanted,
                                .outputs = on_outputs,
                                .event = on_event,
                                .step = on_step,
                                .extremes = run->extremes,
                                .numbers = run->numbers};
    simulate(&run->prepared, &sink, state, &result);
    progress_end(&run->progress);
    if (result.end == SIMULATE_SINK_FAILED || !put_extremes(run) || (run->numbers != NULL && !put_numbers(run))) {
        history_abandon(&run->history);
    } else {
        conclude(run, &result, path);
    }
    extremes_delete(&run->extremes);
    numbers_delete(&run->numbers);
}

static void run_prepared(run *run, const run_options *options, const char *path)
{
    dae_state state;
    if (!prepare_start(&run->prepared, &state, run->error)) {
        return;
    }
    warn_of_case(&run->prepared);
    tell_vibrations(run);
    want_outputs(run);
    progress_start(&run->progress, !options->quiet, state.t, case_description(run->prepared.file)->simulation.duration);
    if (create_history(run, path)) {
        simulate_case(run, path, &state);
    }
    dae_state_free(&state);
}

/** Everything that can be refused is refused before the output file is touched. */
static evl_exit run_case(const char *file, const void *given, evl_error *error)
{
    const run_options *options = given;
    run run = {.error = error};
    log_set_quiet(options->quiet);
    interrupt_install();
    OWNED char *path = result_path("history", options->output, file, "", error);
    OWNED const char **set = xcalloc((size_t)options->set.n + 1, sizeof *set);
    OWNED char *outputs = xasprintf("simulation.outputs=%s", options->outputs == NULL ? "" : options->outputs);
    const int n_set = options->set.n + (options->outputs == NULL ? 0 : 1);
    for (int i = 0; i < n_set; i++) {
        set[i] = i < options->set.n ? options->set.values[i] : outputs;
    }
    if (path != NULL && prepare_case(&run.prepared, file, n_set, set, error)) {
        run_prepared(&run, options, path);
    }
    prepared_case_free(&run.prepared);
    pool_free(&run.pool);
    return error->code;
}

static const option_row rows[] = {
    {OPTION_TEXT, 'o', "--output", "HISTORY.h5", offsetof(run_options, output),
     "file to write; the case's name with .h5 in the current folder if not given"},
    {OPTION_TEXT, 0, "--outputs", "NAMES", offsetof(run_options, outputs),
     "variables over time and groups of them, with commas, that the history has, as of simulation.outputs"},
    OPTION_ROW_SET(run_options),
    OPTION_ROW_QUIET(run_options),
    OPTION_ROW_HELP,
};

const command run_command = {
    .name = "run",
    .synopsis = "CASE.yaml [-o HISTORY.h5] [--outputs NAMES] [--set PATH=VALUE]... [-q]",
    .summary = "integrate a case, write its history",
    .text =
        "Integrates the case and writes its time history, an HDF5 file that netCDF-4 readers open. It grows as\n"
        "HISTORY.h5.partial and gets its name when the run is complete, replacing an older one. A run that fails "
        "or is\n"
        "interrupted leaves the .partial, readable, with the reason in its attributes. Where stderr is no terminal,\n"
        "a line a minute tells how far it is. CASE.yaml may be -, standard input.\n"
        "\n"
        "Examples:\n"
        "  evolvent run examples/paper.yaml\n"
        "  evolvent run examples/paper.yaml -o f03.h5 --set meshes.0.friction.coefficient=0.3\n"
        "  evolvent run examples/paper.yaml --outputs energies,transmission_error\n",
    .file = "case file",
    .size = sizeof(run_options),
    OPTION_ROWS(rows),
    .run = run_case,
};
