#include "respond/respond.h"

#include "base/interrupt.h"
#include "base/log.h"
#include "base/number.h"
#include "base/progress.h"
#include "case/unit_spelling.h"
#include "integrate/integrate.h"
#include "respond/branch.h"
#include "respond/respond_orbits.h"
#include "respond/respond_summary.h"
#include "respond/resume.h"
#include "simulate/metric_channel.h"

#include <evolvent_version.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { LEAST_MOST = 100 };
const char respond_periods[] = "--periods takes a whole number of common periods from 100 to 1000000";
const char respond_values[] = "--values takes a whole number from 2 to 100000";
const char respond_longest[] = "--longest takes a whole number of common periods from 1 to 16";

typedef struct {
    const respond_options *options;
    value_range range;
    branch branch;
    case_plan first; /**< of the first value: its text and warnings are written to the file */
    resume resume;
    const volatile sig_atomic_t *interrupt;
    double shown;  /**< wall clock [s] */
    bool is_shown; /**< the terminal's line is not empty */
} response_run;

/* ---- checkpoints ---- */

/** Set the identification of the checkpoint. */
static void identify(response_run *run)
{
    const respond_options *options = run->options;
    CLEANUP_FREE char *text =
        options->orbits != NULL
            ? xasprintf("orbits over: %s\nmost: %d\nvalues: %d\nlongest: %d\n%s", options->over, options->most,
                        options->n_values, options->longest, case_text(run->first.file))
            : xasprintf("over: %s\nup: %d\ndown: %d\nmost: %d\n%s", options->over, options->up, options->down,
                        options->most, case_text(run->first.file));
    resume_identify(&run->resume, text);
}

static void serialize(void *self, archive *archive)
{
    branch_serialize(self, archive);
}

/** Resume from the checkpoint of an earlier run, if there is one. */
static bool take_up(response_run *run, evl_error *error)
{
    bool found = false;
    const bool good = resume_read(&run->resume, &found, error);
    if (found) {
        log_note("continues after %d of %d values", run->branch.step, run->branch.n_steps);
    }
    return good;
}

static bool save(response_run *run, evl_error *error)
{
    return resume_save(&run->resume, run->branch.step, error);
}

/* ---- the file ---- */

static bool write_file(response_run *run, bool commit, const char *status, const char *message, evl_error *error)
{
    branch *b = &run->branch;
    const description *description = run->first.description;
    CLEANUP_FREE char *warnings = case_plan_warnings(&run->first, NULL, "\n"), *unit = unit_of_results(run->range.unit);
    CLEANUP_FREE double *values = xcalloc((size_t)run->range.n, sizeof *values);
    for (int i = 0; i < run->range.n; i++) {
        values[i] = value_range_at(&run->range, i);
    }
    const history_attribute attributes[] = {
        {"title", .text = description->title},
        {"case", .text = case_text(run->first.file)},
        {"parameter", .text = run->range.path},
        {"versions", .text = run->options->versions},
        {"warnings", .text = warnings},
        {"values_done", .integer = b->step},
        {"status", .text = status},
        {"status_message", .text = message},
    };
    const response result = {
        .path = run->options->path,
        .parameter = run->range.path,
        .units = unit,
        .n = run->range.n,
        .values = values,
        .names = b->names,
        .n_harmonics = METRIC_HARMONICS,
        .n_outputs = METRICS_OF_ALL_MODELS,
        .n_values = b->n_values,
        .outputs = b->rows,
        .points = {b->goes[0] ? b->points[0] : NULL, b->goes[1] ? b->points[1] : NULL},
        .n_jumps = b->n_jumps,
        .jumps = b->jumps,
        .n_attributes = sizeof attributes / sizeof *attributes,
        .attributes = attributes,
        .in_memory = run->options->in_memory,
    };
    if (commit && run->options->on_response != NULL) {
        run->options->on_response(run->options->self, &result);
    }
    return response_write(&result, commit, error);
}

/* ---- the values ---- */

static void show(response_run *run, const branch_cursor *at)
{
    static const double often = 0.2;
    const bool on_terminal = progress_is_on_terminal();
    const double now = clock_seconds(), interval = on_terminal ? often : progress_log_interval();
    if (run->options->quiet || now - run->shown < interval) {
        return;
    }
    run->shown = now;
    run->is_shown = on_terminal;
    CLEANUP_FREE char *option = value_range_option(&run->range, value_range_at(&run->range, at->index));
    CLEANUP_FREE char *text = xasprintf("%s %s, %d of %d values", at->direction == 0 ? "up" : "down", option,
                                        run->branch.step, run->branch.n_steps);
    progress_show(on_terminal, text);
}

/** Compute all remaining values. @return how it ended; the reason of a failure is in `error` */
static orbit_end go(response_run *run, evl_error *error)
{
    orbit_end end = ORBIT_FOUND;
    while (run->branch.step < run->branch.n_steps && end == ORBIT_FOUND) {
        const branch_cursor at = branch_at(&run->branch, run->branch.step);
        show(run, &at);
        end = branch_step(&run->branch, error);
        if (end == ORBIT_FOUND && resume_is_due(&run->resume) && !save(run, error)) {
            return ORBIT_FAILED;
        }
    }
    if (run->is_shown) {
        progress_wipe();
    }
    return end;
}

/** Check all values before the first one is computed; an interrupt ends the check. */
static bool check_values(response_run *run, evl_error *error)
{
    model_period period;
    for (int i = 0; i < run->range.n && *run->interrupt == 0; i++) {
        if (!branch_plan(&run->branch, value_range_at(&run->range, i), &period, error)) {
            return false;
        }
    }
    return true;
}

/** Write the results so far, and report how to resume. */
static void give_up(response_run *run, bool is_interrupted, evl_error *error)
{
    evl_error other = {.code = EVL_EXIT_OK};
    const branch *b = &run->branch;
    const respond_options *options = run->options;
    const char *who = (options->who != NULL ? options->who : interrupt_name)((int)*run->interrupt);
    CLEANUP_FREE char *why = is_interrupted ? xasprintf("interrupted by %s", who) : xstrdup(error->message);
    CLEANUP_FREE char *where =
        options->in_memory != NULL ? xstrdup("") : xasprintf(" and in '%s.partial'", options->path);
    CLEANUP_FREE char *location = xstrdup(is_interrupted ? run->first.path : error->location);
    const bool good =
        save(run, &other) && write_file(run, false, is_interrupted ? "interrupted" : "failed", why, &other);
    if (!good) {
        *error = other;
    } else if (is_interrupted) {
        evl_error_set(error, EVL_EXIT_INTERRUPTED, location, "%s; %d of %d values are done%s%s", why, b->step,
                      b->n_steps, where, options->in_memory != NULL ? "" : "; repeat the command to continue");
    } else {
        evl_error_set(error, error->code, location, "%s; %d of %d values are done%s", why, b->step, b->n_steps, where);
    }
}

/** @return whether all values are complete and written */
static bool run_locked(response_run *run, evl_error *error)
{
    bool done = false;
    if (!take_up(run, error)) {
        return false;
    }
    run->shown = clock_seconds();
    const orbit_end end = go(run, error);
    if (end != ORBIT_FOUND) {
        if (error->code != EVL_EXIT_IO) {
            give_up(run, end == ORBIT_INTERRUPTED, error);
        }
    } else if (write_file(run, true, "done", "", error)) {
        done = true;
        if (run->options->in_memory == NULL) {
            respond_warn_of_settling(&run->branch);
        }
        if (!run->options->quiet) {
            respond_summarise(&run->branch, run->options->path);
        }
    }
    return done;
}

static case_base *read_base(const char *name, const char *text, evl_error *error)
{
    return text == NULL ? case_base_read(name, model_schema(), error)
                        : case_base_parse(name, text, model_schema(), error);
}

/** Find orbits instead of motions. @return whether all are complete and written */
static bool find_orbits(response_run *run, evl_error *error)
{
    CLEANUP_FREE char *unit = unit_of_results(run->range.unit), *warnings = case_plan_warnings(&run->first, NULL, "\n");
    const respond_orbits_setup setup = {.sweep = &run->branch,
                                        .first = &run->first,
                                        .resume = &run->resume,
                                        .unit = unit,
                                        .warnings = warnings,
                                        .options = run->options};
    return run->options->orbits(&setup, error);
}

/** Read the range; its units are those of the key in the case modified by --set. */
static bool read_range(response_run *run, const char *case_path, evl_error *error)
{
    const respond_options *options = run->options;
    case_base *base = read_base(case_path, case_text(run->first.file), error);
    const bool good = base != NULL && value_range_read(&run->range, options->over, base, error);
    case_base_delete(&base);
    if (options->orbits != NULL && !run->range.is_counted) {
        run->range.n = 2; /* start from the motions at both ends */
    }
    return good;
}

/** Prepare the case at its first value, identify the results, and check the other values. */
static bool begin(response_run *run, const char *case_path, evl_error *error)
{
    branch *b = &run->branch;
    const respond_options *options = run->options;
    ARENA_SCOPE memory_arena arena = {NULL};
    b->wheels = options->wheels != NULL ? options->wheels : wheel_store_create();
    b->base = read_base(case_path, options->text, error);
    if (b->base == NULL) {
        return false;
    }
    evl_error other = {.code = EVL_EXIT_OK}; /* of a model without the parameter's values */
    plan_request request = {.name = case_path,
                            .text = options->text,
                            .n_set = options->n_set,
                            .set = options->set,
                            .wheels = wheel_store_door(b->wheels)};
    const bool has_model = case_plan_make(&run->first, &request, &other);
    if (run->first.file == NULL) {
        *error = other;
        return false;
    }
    if (!read_range(run, case_path, error) ||
        (has_model && !value_range_check(&run->range, run->first.model, false, error))) {
        return false;
    }
    CLEANUP_FREE char *option = value_range_option(&run->range, run->range.from);
    const char **set = arena_calloc(&arena, (size_t)options->n_set + 1, sizeof *set);
    for (int i = 0; i < options->n_set; i++) {
        set[i] = options->set[i];
    }
    set[options->n_set] = option; /* the last option: without it the case is the original one */
    case_plan_free(&run->first);
    request.n_set++;
    request.set = set;
    if (!case_plan_make(&run->first, &request, error) ||
        !value_range_check(&run->range, run->first.model, true, error)) {
        return false;
    }
    b->range = &run->range;
    b->n_set = options->n_set;
    b->set = options->set;
    b->most = options->most;
    b->interrupt = run->interrupt;
    b->names = &model_about(run->first.model)->names;
    b->n_values = metric_rows_lay_out(b->names, b->rows);
    b->goes[0] = options->up;
    b->goes[1] = options->down;
    b->n_steps = (options->up + options->down) * run->range.n;
    for (int d = 0; d < RESPONSE_DIRECTIONS; d++) {
        b->points[d] = arena_calloc(&b->arena, (size_t)run->range.n, sizeof *b->points[d]);
        for (int i = 0; i < run->range.n; i++) {
            b->points[d][i].period = -1;
        }
    }
    identify(run);
    return check_values(run, error);
}

/** @return false if a text is not an integer from `least` to `most` */
static bool read_count(const char *text, int least, int most, int *n)
{
    double value = 0;
    const bool good =
        number_read(text, &value) == NUMBER_FINITE && value >= least && value <= most && value == floor(value);
    *n = good ? (int)value : 0;
    return good;
}

bool respond_read_most(const char *text, int *most)
{
    return read_count(text, LEAST_MOST, RESPOND_MOST, most);
}

bool respond_read_values(const char *text, int *n)
{
    return read_count(text, 2, RANGE_MOST_STEPS, n);
}

bool respond_read_longest(const char *text, int *n)
{
    return read_count(text, 1, ORBIT_LONGEST, n);
}

static response_run *run_create(const respond_options *options)
{
    response_run *run = xcalloc(1, sizeof *run);
    run->options = options;
    run->interrupt = options->interrupt != NULL ? options->interrupt : &interrupt_signal;
    run->resume.self = &run->branch;
    run->resume.serialize = serialize;
    return run;
}

static void run_delete(response_run *run)
{
    if (run->options->wheels != NULL) {
        run->branch.wheels = NULL; /* owned by the caller */
    }
    branch_free(&run->branch);
    case_plan_free(&run->first);
    value_range_free(&run->range);
    checkpoint_free(&run->resume.of);
    free(run);
}

evl_exit respond_check(const char *case_path, const respond_options *options, evl_error *error)
{
    response_run *run = run_create(options);
    (void)begin(run, case_path, error);
    run_delete(run);
    return error->code;
}

evl_exit respond(const char *case_path, const respond_options *options, evl_error *error)
{
    response_run *run = run_create(options);
    if (begin(run, case_path, error) && resume_open(&run->resume, options->path, error)) {
        const bool done = options->orbits != NULL ? find_orbits(run, error) : run_locked(run, error);
        resume_close(&run->resume, done);
    }
    run_delete(run);
    return error->code;
}
