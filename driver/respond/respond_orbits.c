#include "respond/respond_orbits.h"

#include "base/interrupt.h"
#include "base/log.h"
#include "base/progress.h"
#include "respond/branches.h"
#include "respond/branches_points.h"
#include "simulate/metric_channel.h"

#include <math.h>
#include <stdio.h>

typedef struct {
    const respond_orbits_setup *setup;
    branches found;
    double shown;  /**< wall clock [s] */
    bool is_shown; /**< the terminal's line is not empty */
} orbits_run;

static void show(orbits_run *run)
{
    static const double often = 0.2;
    const branches *found = &run->found;
    const bool on_terminal = progress_is_on_terminal();
    const double now = clock_seconds(), interval = on_terminal ? often : progress_log_interval();
    if (run->setup->options->quiet || now - run->shown < interval) {
        return;
    }
    run->shown = now;
    run->is_shown = on_terminal;
    CLEANUP_FREE char *option =
        value_range_option(found->sweep->range, value_range_at(found->sweep->range, found->value));
    CLEANUP_FREE char *text =
        xasprintf("orbits from %s: %d branches, %d points", option, found->n_branches, found->n_points);
    progress_show(on_terminal, text);
}

static bool write_file(const branches *found, const respond_orbits_setup *setup, const char *status,
                       const char *message, bool commit, evl_error *error)
{
    const branch *sweep = setup->sweep;
    const history_attribute attributes[] = {
        {"title", .text = setup->first->description->title},
        {"case", .text = case_text(setup->first->file)},
        {"parameter", .text = sweep->range->path},
        {"versions", .text = setup->options->versions},
        {"warnings", .text = setup->warnings},
        {"status", .text = status},
        {"status_message", .text = message},
    };
    const orbit_branches result = {
        .path = setup->options->path,
        .parameter = sweep->range->path,
        .units = setup->unit,
        .names = sweep->names,
        .n_harmonics = METRIC_HARMONICS,
        .n_outputs = METRICS_OF_ALL_MODELS,
        .n_values = sweep->n_values,
        .outputs = sweep->rows,
        .n_branches = found->n_branches,
        .branches = found->branches,
        .n_points = found->n_points,
        .points = found->points,
        .n_attributes = sizeof attributes / sizeof *attributes,
        .attributes = attributes,
    };
    return orbits_write(&result, commit, error);
}

static void summarise(const branches *found, const respond_orbits_setup *setup)
{
    static const char *const kinds[MODEL_ORBIT_GRAZING_FOLD + 1] = {
        [MODEL_ORBIT_FOLD] = "fold",
        [MODEL_ORBIT_CROSSING] = "crossing of branches",
        [MODEL_ORBIT_DOUBLING] = "period doubling",
        [MODEL_ORBIT_NEIMARK_SACKER] = "Neimark-Sacker point",
        [MODEL_ORBIT_GRAZING_FOLD] = "fold with grazing of a tooth pair",
    };
    int n_stable = 0, n_ordinary = 0;
    for (int i = 0; i < found->n_points; i++) {
        const model_orbit *orbit = &found->points[i].orbit;
        n_ordinary += orbit->kind == MODEL_ORBIT_ORDINARY;
        n_stable += orbit->kind == MODEL_ORBIT_ORDINARY && orbit->is_stable;
        if (kinds[orbit->kind] != NULL) {
            log_note("branch %d, period %d: %s at %.9g%s%s", found->points[i].branch, orbit->periods,
                     orbit->kind == MODEL_ORBIT_GRAZING_FOLD && orbit->whole_mesh ? "fold with grazing of the mesh"
                                                                                  : kinds[orbit->kind],
                     orbit->parameter, setup->unit[0] == '\0' ? "" : " ", setup->unit);
        }
    }
    for (int i = 0; i < found->n_branches; i++) {
        if (found->branches[i].end[0] != '\0') {
            log_note("branch %d ends: %s", i, found->branches[i].end);
        }
    }
    for (int i = 0; i < found->n_branches; i++) {
        double first = NAN;
        const int n = branches_left_out(found, i, &first);
        if (n > 0) {
            log_note("branch %d passes %d of the values with no orbit found there, the first at %.9g%s%s", i, n, first,
                     setup->unit[0] == '\0' ? "" : " ", setup->unit);
        }
    }
    for (int i = 0; i < found->n_problems; i++) {
        log_note("%s", found->problems[i]);
    }
    log_note("%d branch%s, %d orbits, %d of them stable: %s", found->n_branches, found->n_branches == 1 ? "" : "es",
             n_ordinary, n_stable, setup->options->path);
}

static bool save(orbits_run *run, evl_error *error)
{
    return resume_save(run->setup->resume, run->found.n_points, error);
}

/** Write the results so far, and report why they are incomplete. */
static void give_up(orbits_run *run, bool is_interrupted, evl_error *error)
{
    evl_error other = {.code = EVL_EXIT_OK};
    const respond_orbits_setup *setup = run->setup;
    const branches *found = &run->found;
    CLEANUP_FREE char *why = is_interrupted ? xasprintf("interrupted by %s", interrupt_name((int)interrupt_signal))
                                            : xstrdup(error->message);
    CLEANUP_FREE char *location = xstrdup(is_interrupted ? setup->first->path : error->location);
    const evl_exit code = is_interrupted ? EVL_EXIT_INTERRUPTED : error->code;
    if (!save(run, &other) ||
        !write_file(found, setup, is_interrupted ? "interrupted" : "failed", why, false, &other)) {
        *error = other;
        return;
    }
    error->code = EVL_EXIT_OK;
    evl_error_set(error, code, location, "%s; %d branches with %d points are in '%s.partial'%s", why, found->n_branches,
                  found->n_points, setup->options->path, is_interrupted ? "; repeat the command to continue" : "");
}

static void serialize(void *self, archive *archive)
{
    branches_serialize(self, archive);
}

/** Resume from the checkpoint of an earlier run, if there is one. */
static bool take_up(orbits_run *run, evl_error *error)
{
    bool found = false;
    if (!resume_read(run->setup->resume, &found, error)) {
        return false;
    }
    if (found && !branches_resume(&run->found, error)) {
        if (interrupt_signal != 0) { /* the checkpoint is not changed */
            error->code = EVL_EXIT_OK;
            evl_error_set(error, EVL_EXIT_INTERRUPTED, run->setup->first->path,
                          "interrupted by %s; repeat the command to continue", interrupt_name((int)interrupt_signal));
        }
        return false;
    }
    if (found) {
        log_note("continues after %d branches with %d points", run->found.n_branches, run->found.n_points);
    }
    return true;
}

/** Do all remaining tasks. @return how it ended; the reason of a failure is in `error` */
static orbit_end go(orbits_run *run, evl_error *error)
{
    orbit_end end = ORBIT_FOUND;
    while (end == ORBIT_FOUND && !branches_are_done(&run->found)) {
        show(run);
        end = branches_step(&run->found, error);
        if (end == ORBIT_FOUND && resume_is_due(run->setup->resume) && !save(run, error)) {
            return ORBIT_FAILED;
        }
    }
    if (run->is_shown) {
        progress_wipe();
    }
    return end;
}

bool respond_orbits(const respond_orbits_setup *setup, evl_error *error)
{
    const respond_options *options = setup->options;
    orbits_run run = {.setup = setup,
                      .found = {.sweep = setup->sweep,
                                .n_values = options->n_values,
                                .longest = options->longest > 0 ? options->longest : ORBIT_LONGEST},
                      .shown = clock_seconds()};
    bool done = false;
    setup->resume->self = &run.found;
    setup->resume->serialize = serialize;
    if (take_up(&run, error)) {
        const orbit_end end = go(&run, error);
        if (end != ORBIT_FOUND && error->code != EVL_EXIT_IO) {
            give_up(&run, end == ORBIT_INTERRUPTED, error);
        } else if (end == ORBIT_FOUND && write_file(&run.found, setup, "done", "", true, error)) {
            summarise(&run.found, setup);
            done = true;
        }
    }
    branches_free(&run.found);
    return done;
}
