#include "respond/respond_orbits.h"

#include "base/interrupt.h"
#include "base/log.h"
#include "base/progress.h"
#include "respond/branches.h"
#include "simulate/number_channel.h"

#include <stdio.h>

typedef struct {
    const respond_orbits_setup *setup;
    bool is_shown; /**< something stands on the terminal's line */
} teller;

static void tell(void *self, const char *what)
{
    teller *t = self;
    if (!t->setup->options->quiet && progress_is_on_terminal()) {
        OWNED char *text = xasprintf("orbits from %s", what);
        progress_show(true, text);
        t->is_shown = true;
    }
}

static bool write_file(const branches *found, const respond_orbits_setup *setup, const char *status,
                       const char *message, bool commit, evl_error *error)
{
    const branch *sweep = setup->sweep;
    const history_attribute attributes[] = {
        {"title", .text = case_description(setup->first->file)->title},
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
        .n_harmonics = NUMBER_HARMONICS,
        .n_outputs = N_NUMBER_ROWS,
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
    static const char *const kinds[] = {"", "fold", "crossing of branches", "period doubling", "Neimark-Sacker point",
                                        ""};
    int n_stable = 0, n_ordinary = 0;
    for (int i = 0; i < found->n_points; i++) {
        const model_orbit *orbit = &found->points[i].orbit;
        n_ordinary += orbit->kind == MODEL_ORBIT_ORDINARY;
        n_stable += orbit->kind == MODEL_ORBIT_ORDINARY && orbit->largest < 1;
        if (kinds[orbit->kind][0] != '\0') {
            log_note("branch %d, period %d: %s at %.9g%s%s", found->points[i].branch, orbit->periods,
                     kinds[orbit->kind], orbit->parameter, setup->unit[0] == '\0' ? "" : " ", setup->unit);
        }
    }
    for (int i = 0; i < found->n_branches; i++) {
        if (found->branches[i].end[0] != '\0') {
            log_note("branch %d ends: %s", i, found->branches[i].end);
        }
    }
    for (int i = 0; i < found->n_problems; i++) {
        log_note("%s", found->problems[i]);
    }
    log_note("%d branch%s, %d orbits, %d of them stable: %s", found->n_branches, found->n_branches == 1 ? "" : "es",
             n_ordinary, n_stable, setup->options->path);
}

/** What was found so far stays, and why it is no more is told. */
static void give_up(const branches *found, const respond_orbits_setup *setup, bool is_interrupted, evl_error *error)
{
    evl_error other = {.code = EVL_EXIT_OK};
    OWNED char *why = is_interrupted ? xasprintf("interrupted by %s", interrupt_name((int)interrupt_signal))
                                     : xstrdup(error->message);
    OWNED char *place = xstrdup(is_interrupted ? case_path(setup->first->file) : error->place);
    const evl_exit code = is_interrupted ? EVL_EXIT_INTERRUPTED : error->code;
    if (!write_file(found, setup, is_interrupted ? "interrupted" : "failed", why, false, &other)) {
        *error = other;
        return;
    }
    error->code = EVL_EXIT_OK;
    evl_error_set(error, code, place, "%s; %d branches with %d points are in '%s.partial'", why, found->n_branches,
                  found->n_points, setup->options->path);
}

bool respond_orbits(const respond_orbits_setup *setup, evl_error *error)
{
    teller teller = {.setup = setup};
    branches found = {
        .sweep = setup->sweep, .n_values = setup->options->n_values, .told = tell, .self = &teller};
    const orbit_end end = branches_find(&found, error);
    if (teller.is_shown) {
        progress_wipe();
    }
    bool done = false;
    if (end != ORBIT_FOUND) {
        give_up(&found, setup, end == ORBIT_INTERRUPTED, error);
    } else if (write_file(&found, setup, "done", "", true, error)) {
        summarise(&found, setup);
        done = true;
    }
    branches_free(&found);
    return done;
}
