#include "analyses/run_history.h"
#include "analyses/show_geometry.h"
#include "base/interrupt.h"
#include "base/log.h"
#include "base/memory.h"
#include "base/progress.h"
#include "base/words.h"
#include "commands/cached_case.h"
#include "commands/checkpoints.h"
#include "commands/command.h"
#include "commands/result.h"
#include "commands/run_metrics.h"
#include "commands/warn.h"
#include "integrate/integrate_types.h"
#include "model/model_start.h"
#include "simulate/case_start.h"
#include "simulate/simulate.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

typedef struct {
    const char *output;  /**< NULL: the case's name with .h5 in the current folder */
    const char *outputs; /**< names of variables and groups; NULL: as in the case */
    checkpoint_options checkpoint;
    option_values set;
    bool quiet;
} run_options;

typedef struct {
    case_plan plan;
    model_start_orbit start; /**< orbit of a periodic start */
    run_history history;     /**< or its present part */
    simulate_sink sink;
    checkpoints *checkpoints; /**< NULL: the run cannot be resumed */
    progress progress;
    double t_shown; /**< last model time shown [s] */
    evl_error *error;
} run;

/* ---- outputs of the simulation ---- */

/** Open the part to which rows or events are to be appended. */
static bool has_part(run *run, int n_rows, int n_events)
{
    if (run->checkpoints == NULL) {
        return true;
    }
    checkpoints_count(run->checkpoints, n_rows, n_events);
    return run->history.history != NULL ||
           run_history_open(&run->history, checkpoints_part(run->checkpoints), run->error);
}

static bool on_outputs(void *self, const output_block *block)
{
    run *run = self;
    return has_part(run, block->n, 0) && run_history_outputs(&run->history, block, run->error);
}

static bool on_event(void *self, const event_record *record)
{
    run *run = self;
    return has_part(run, 0, 1) && run_history_event(&run->history, record, run->error);
}

static void on_step(void *self, double t)
{
    run *run = self;
    run->t_shown = fmax(t, run->t_shown);
    progress_step(&run->progress, run->t_shown);
}

static bool is_due(void *self, double t)
{
    const run *run = self;
    return checkpoints_is_due(run->checkpoints, t);
}

static void serialize(void *self, archive *archive)
{
    const run *run = self;
    checkpoints_serialize(run->checkpoints, archive);
}

static simulate_checkpoint_outcome write_checkpoint(void *self, double t, const archive *archive)
{
    run *run = self;
    return checkpoints_write(run->checkpoints, &run->history.history, t, archive, run->error);
}

/* ---- the run ---- */

/** Report the natural frequencies and damping ratios of the meshes. */
static void report_vibrations(const run *run)
{
    const description *description = run->plan.description;
    for (int i = 0; i < description->n_meshes; i++) {
        const model *model = run->plan.model;
        const double ratio = model_quantity(model, EVL_OF_MESH, i, "damping_ratio");
        if (!isnan(ratio)) {
            log_note("mesh %s at %.5g N, one tooth pair: natural frequency %.5g Hz, damping ratio %.3g",
                     description->meshes[i], model_quantity(model, EVL_OF_MESH, i, "reference_force"),
                     model_quantity(model, EVL_OF_MESH, i, "natural_frequency"), ratio);
        }
    }
    CLEANUP_FREE char *note = stiffness_note(description, run->plan.model);
    if (note[0] != '\0') {
        log_note("%s", note);
    }
}

/** Report the orbit of a periodic start. */
static void report_orbit(const run *run)
{
    const model_start_orbit *orbit = &run->start;
    if (orbit->pitches == 0) {
        return;
    }
    CLEANUP_FREE char *length =
        orbit->pitches == 1 ? xstrdup("")
                            : xasprintf(" of %d pitches of mesh %s", orbit->pitches, run->plan.description->meshes[0]);
    CLEANUP_FREE char *constant =
        orbit->time_constant > 0 ? xasprintf(", slowest time constant %.4g s", orbit->time_constant) : xstrdup("");
    const double size = model_start_multiplier(orbit);
    CLEANUP_FREE char *multiplier = size > 0                ? xasprintf("largest Floquet multiplier %.4g", size)
                                    : orbit->has_multiplier ? xstrdup("largest Floquet multiplier below 1e-10")
                                                            : xstrdup("no Floquet multiplier");
    log_note("start on a periodic orbit%s, period %.6g s: %s%s%s; search with %d integrations of a period", length,
             orbit->time, multiplier, orbit->ties > 0 ? " (approximate: events coincide)" : "", constant, orbit->flows);
}

static void summarise(const integrate_counts *counts, const char *path)
{
    log_note("%ld steps, %ld event%s, %.3g s CPU: %s", counts->steps, counts->events, counts->events == 1 ? "" : "s",
             (double)clock() / CLOCKS_PER_SEC, path);
}

/** Warn if the invariants do not hold. */
static void warn_of_invariants(const run *run, const simulate_result *result)
{
    const bool is_stated = run->plan.description->simulation.accuracy > 0;
    if (!result->held) {
        log_warning("the run's own invariants are %s: lower simulation.%s, or give a smaller simulation.max_step",
                    result->invariants, is_stated ? "accuracy" : "tolerance");
    }
}

/** Report why the history is incomplete. */
static void refuse_end(const run *run, const simulate_result *result)
{
    const char *partial = run_history_partial_path(&run->history);
    CLEANUP_FREE char *location = xasprintf("%s: t = %.9g s", run->plan.path, result->t);
    if (result->end == SIMULATE_INTERRUPTED) {
        evl_error_set(run->error, EVL_EXIT_INTERRUPTED, location,
                      "interrupted by %s; the history up to there is in '%s'", interrupt_name((int)interrupt_signal),
                      partial);
    } else if (result->end == SIMULATE_FAILED) {
        evl_error_set(run->error, EVL_EXIT_INTEGRATION, location, "%s; the history up to there is in '%s'",
                      result->message, partial);
    }
}

/** The run ended: complete the history, and print the summary. */
static void conclude(run *run, const simulate_result *result, const char *path)
{
    if (result->remark[0] != '\0') {
        log_warning("%s", result->remark);
    }
    refuse_end(run, result);
    const bool is_done = result->end == SIMULATE_DONE;
    const char *times = run->checkpoints != NULL ? checkpoints_times(run->checkpoints) : "";
    if (run_history_close(&run->history, interrupt_name((int)interrupt_signal), result, times, run->error) && is_done) {
        summarise(&result->counts, path);
        warn_of_invariants(run, result);
    }
}

/** The run was stopped after a checkpoint: its parts are not changed. */
static void conclude_stopped(const run *run, const simulate_result *result)
{
    CLEANUP_FREE char *location = xasprintf("%s: t = %.9g s", run->plan.path, result->t);
    if (result->can_go_on) {
        evl_error_set(run->error, EVL_EXIT_INTEGRATION, location, "%s; with more steps it continues from here with: %s",
                      result->message, checkpoints_command(run->checkpoints));
    } else {
        checkpoints_explain(run->checkpoints, location, run->error);
    }
}

/** Join all parts to one history, which can then be completed. */
static bool join_parts(run *run, const char *path)
{
    run_history *history = &run->history;
    return checkpoints_close_part(run->checkpoints, &history->history, run->error) &&
           run_history_open(history, path, run->error) &&
           checkpoints_append(run->checkpoints, history->history, run->error);
}

/** The simulation ended: complete the history, or stop after a checkpoint. */
static void conclude_all(run *run, const simulate_result *result, const char *path)
{
    const bool has_checkpoints = run->checkpoints != NULL;
    const bool goes_on = has_checkpoints && (result->end == SIMULATE_INTERRUPTED || result->can_go_on);
    if (goes_on) {
        conclude_stopped(run, result);
    } else if (result->end == SIMULATE_SINK_FAILED || (has_checkpoints && !join_parts(run, path)) ||
               !run_history_put(&run->history, run->error)) {
        run_history_abandon(&run->history);
    } else {
        if (run->history.metrics != NULL) {
            report_metrics(run->history.metrics, &model_about(run->plan.model)->names);
        }
        conclude(run, result, path);
    }
    if (has_checkpoints && run->error->code == EVL_EXIT_IO) {
        checkpoints_remind(run->checkpoints, run->error);
    } else if (has_checkpoints && !goes_on) {
        checkpoints_remove(run->checkpoints);
    }
}

/** Prepare the repetition of all since the last checkpoint. */
static bool again(void *self)
{
    run *run = self;
    run_history_abandon(&run->history);
    const bool good = checkpoints_again(run->checkpoints, run->error);
    run->sink.resume = checkpoints_resume(run->checkpoints);
    return good;
}

/** Simulate from the start, or the last checkpoint. */
static void simulate_case(run *run, const char *path, const dae_state *start)
{
    simulate_result result;
    run->sink = (simulate_sink){.self = run, .outputs = on_outputs, .event = on_event, .step = on_step};
    if (run->checkpoints != NULL) {
        run->sink.is_due = is_due;
        run->sink.serialize = serialize;
        run->sink.write_checkpoint = write_checkpoint;
        run->sink.checkpoint_at_limit = true;
        run->sink.resume = checkpoints_resume(run->checkpoints);
    }
    run_history_simulate(&run->history, &run->sink, start, run->checkpoints == NULL ? NULL : again, &result);
    progress_end(&run->progress);
    conclude_all(run, &result, path);
}

/** Command that resumes the run. */
static const char *command_of(memory_arena *arena, const char *file, const run_options *options, const char *path)
{
    CLEANUP_FREE char *quoted_file = words_quoted(file), *quoted_path = words_quoted(path);
    const char *text = arena_printf(arena, "evolvent run %s -o %s", quoted_file, quoted_path);
    if (options->outputs != NULL) {
        CLEANUP_FREE char *outputs = words_quoted(options->outputs);
        text = arena_printf(arena, "%s --outputs %s", text, outputs);
    }
    for (int i = 0; i < options->set.n; i++) {
        CLEANUP_FREE char *set = words_quoted(options->set.values[i]);
        text = arena_printf(arena, "%s --set %s", text, set);
    }
    return arena_printf(arena, "%s --continue", text);
}

/** Prepare checkpoints if requested. */
static bool open_checkpoints(run *run, const char *file, const run_options *options, const char *path)
{
    ARENA_SCOPE memory_arena arena = {NULL};
    if (checkpoint_options_any(&options->checkpoint)) {
        const char *command = command_of(&arena, file, options, path);
        run->checkpoints = checkpoints_open(&options->checkpoint, path, command, &run->plan, run->error);
    }
    return run->error->code == EVL_EXIT_OK;
}

static void run_plan(run *run, const char *file, const run_options *options, const char *path)
{
    dae_state state;
    if (!case_start(&run->plan, &interrupt_signal, &state, &run->start, run->error)) {
        return;
    }
    warn_of_case(&run->plan, &run->start);
    report_vibrations(run);
    report_orbit(run);
    if (open_checkpoints(run, file, options, path)) {
        const double t = run->checkpoints == NULL ? state.t : checkpoints_time(run->checkpoints);
        progress_start(&run->progress, !options->quiet, t, run->plan.integration.t_end);
        run_history_init(&run->history, &run->plan, &run->start);
        if (run->checkpoints != NULL || run_history_open(&run->history, path, run->error)) {
            simulate_case(run, path, &state);
        }
        run_history_free(&run->history);
    }
    checkpoints_close(&run->checkpoints);
    dae_state_free(&state);
}

/** All checks are made before the output file is touched. */
static evl_exit run_case(const char *file, const void *given, evl_error *error)
{
    const run_options *options = given;
    run run = {.error = error};
    log_set_quiet(options->quiet);
    interrupt_install();
    CLEANUP_FREE char *path = result_path("history", options->output, file, ".h5", error);
    ARENA_SCOPE memory_arena arena = {NULL};
    const option_values set = set_with_outputs(&options->set, options->outputs, &arena);
    if (path != NULL && cached_case(&run.plan, file, &set, PLAN_ROOTS_OF_CASE, error)) {
        run_plan(&run, file, options, path);
    }
    case_plan_free(&run.plan);
    return error->code;
}

static const char *check_options(const void *given)
{
    const run_options *options = given;
    return checkpoint_options_check(&options->checkpoint);
}

static const option_row rows[] = {
    {OPTION_TEXT, 'o', "--output", "HISTORY.h5", offsetof(run_options, output),
     "file to write; the case's name with .h5 in the current folder if not given"},
    {OPTION_TEXT, 0, "--outputs", "NAMES", offsetof(run_options, outputs),
     "variables and groups of variables in the history, separated by commas, as for simulation.outputs"},
    {OPTION_TEXT, 0, "--checkpoint", "MINUTES", offsetof(run_options, checkpoint.minutes),
     "write a checkpoint every MINUTES minutes and on interruption, for --continue"},
    {OPTION_TEXT, 0, "--checkpoint-at", "TIMES", offsetof(run_options, checkpoint.at),
     "also write a checkpoint at these model times [s], separated by commas"},
    {OPTION_TEXT, 0, "--max-time", "MINUTES", offsetof(run_options, checkpoint.max_minutes),
     "write a checkpoint and stop after at most MINUTES minutes"},
    {OPTION_FLAG, 0, "--continue", NULL, offsetof(run_options, checkpoint.continues),
     "resume from the last checkpoint: add this to the original command"},
    OPTION_ROW_SET(run_options),
    OPTION_ROW_QUIET(run_options),
    OPTION_ROW_HELP,
};

const command run_command = {
    .name = "run",
    .synopsis =
        "CASE.yaml [-o HISTORY.h5] [--outputs NAMES] [--set PATH=VALUE]... [--checkpoint MINUTES] [--continue] [-q]",
    .summary = "simulate a case and write its time history",
    .text =
        "Simulates the case and writes its time history, an HDF5 file that netCDF-4 programs can read. The file is\n"
        "written as HISTORY.h5.partial and renamed when the run is complete; it replaces an existing file. A\n"
        "failed or interrupted run leaves a readable .partial file, with the reason in its attributes. If stderr\n"
        "is not a terminal, progress is printed once a minute. CASE.yaml may be -, standard input.\n"
        "\n"
        "With --checkpoint or --max-time the history is written in parts, in the folder HISTORY.h5.parts, together\n"
        "with the state of the run. After an interruption, the same command with --continue resumes the run. The\n"
        "history then equals that of an uninterrupted run. With integrator ida it equals that of a run with\n"
        "checkpoints at the same model times. The attribute `checkpoints` of the history lists them for\n"
        "--checkpoint-at.\n"
        "\n"
        "Examples:\n"
        "  evolvent run examples/paper.yaml\n"
        "  evolvent run examples/paper.yaml -o f03.h5 --set meshes.0.friction.coefficient=0.3\n"
        "  evolvent run examples/paper.yaml --outputs energies,transmission_error\n"
        "  evolvent run examples/paper.yaml -o long.h5 --checkpoint 10 --max-time 600\n",
    .file = "case file",
    .size = sizeof(run_options),
    .check = check_options,
    OPTION_ROWS(rows),
    .run = run_case,
};
