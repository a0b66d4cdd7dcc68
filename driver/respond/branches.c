#include "respond/branches.h"

#include "respond/branches_points.h"
#include "respond/shortcut.h"

#include <math.h>
#include <stdio.h>

enum { MOST_BRANCHES = 64 };

/** Callback of the kernel: the model for a value. */
static const model *take(void *self, double value, char message[DAE_MESSAGE_LENGTH])
{
    branches *o = self;
    evl_error error = {.code = EVL_EXIT_OK};
    if (*o->sweep->interrupt != 0) {
        (void)snprintf(message, DAE_MESSAGE_LENGTH, "interrupted");
        return NULL;
    }
    if (!branch_plan_into(o->sweep, &o->plan, value, &o->period, &error)) {
        (void)snprintf(message, DAE_MESSAGE_LENGTH, "%.390s", error.message);
        return NULL;
    }
    return o->plan.model;
}

/** Callback of the kernel: metrics of a candidate orbit; the kernel checks the final state. */
static bool record(void *self, int number, int periods, double *time, dae_state *state)
{
    branches *o = self;
    char message[DAE_MESSAGE_LENGTH];
    if (number >= o->n_recorded) {
        o->recorded =
            arena_grow(&o->arena, o->recorded, (size_t)o->n_recorded, (size_t)number + 1, sizeof *o->recorded);
        for (; o->n_recorded <= number; o->n_recorded++) {
            o->recorded[o->n_recorded] = NULL;
        }
    }
    if (o->recorded[number] == NULL) {
        o->recorded[number] = arena_calloc(&o->arena, (size_t)o->sweep->n_values, sizeof(double));
    }
    const double began = state->t;
    const bool good = orbit_record(&o->plan, &o->period, state, periods, *time / periods, true, o->sweep->interrupt,
                                   state, o->recorded[number], message) == ORBIT_FOUND;
    *time = o->period.by_time ? *time : state->t - began;
    return good;
}

/** Start the branch of the present orbit. */
static void begin_branch(branches *o, bool rising, int parent)
{
    char message[DAE_MESSAGE_LENGTH] = "";
    int n = 0;
    o->is_continuing = model_orbits_begin(o->orbits, rising, &n, message);
    const size_t have = (size_t)o->n_branches;
    o->branches = arena_grow(&o->arena, o->branches, have, have + 1, sizeof *o->branches);
    o->branches[o->n_branches++] = (orbit_branch){.parent = parent, .end = arena_copy(&o->arena, message)};
    branches_take_points(o, n);
    o->progress = model_orbits_walk(o->orbits);
}

/** Find the next point of the branch. */
static void go_on(branches *o)
{
    char message[DAE_MESSAGE_LENGTH] = "";
    bool is_over = false;
    int n = 0;
    o->n_recorded = 0;
    const bool good = model_orbits_advance(o->orbits, &n, &is_over, message);
    if (*o->sweep->interrupt != 0) {
        return;
    }
    branches_take_points(o, n);
    o->branches[o->n_branches - 1].end = arena_copy(&o->arena, message);
    o->is_continuing = good && !is_over;
    o->progress = model_orbits_walk(o->orbits);
}

/** Start the next period-doubled branch, also from doublings on such branches. If there is none left, the value is
 *  complete. */
static void enter_doubling(branches *o)
{
    char message[DAE_MESSAGE_LENGTH];
    while (o->doubling < o->n_points && !o->is_continuing) {
        const orbit_point at = o->points[o->doubling];
        int first = 0;
        for (int i = 0; i < at.branch; i++) {
            first += o->branches[i].n;
        }
        const int point = o->doubling++ - first;
        if (at.orbit.kind != MODEL_ORBIT_DOUBLING || 2 * at.orbit.periods > o->longest ||
            branches_have_entered(o, &at.orbit)) {
            continue;
        }
        if (o->n_branches >= MOST_BRANCHES) {
            branches_note(o, at.orbit.parameter,
                          "the limit of 64 branches is reached: the branch of twice the period is not followed");
            o->doubling = o->n_points;
        } else if (!model_orbits_switch(o->orbits, at.branch, point, message)) {
            branches_note(o, at.orbit.parameter, message);
        } else {
            begin_branch(o, true, at.branch);
        }
    }
    if (!o->is_continuing) {
        o->task = BRANCHES_LOOK;
        o->value++;
    }
}

/** Start the branch of the motion at a value, unless the value is the end of the range in that direction. */
static void begin_direction(branches *o, double value)
{
    const value_range *range = o->sweep->range;
    const bool rises = o->task == BRANCHES_RISE;
    const double last = rises ? fmax(range->from, range->to) : fmin(range->from, range->to);
    char message[DAE_MESSAGE_LENGTH] = "";
    model_orbit orbit;
    o->task++;
    if (value == last) {
        return;
    }
    if (model_orbits_find(o->orbits, value, o->at.period, o->at.time, &o->motion.state, &orbit, message)) {
        begin_branch(o, rises, -1);
    } else {
        branches_note(o, value, message);
        o->task = BRANCHES_DOUBLE;
    }
}

/** Create the kernel's orbit search, with the section of the first motion. */
static bool create_orbits(branches *o, double value, evl_error *error)
{
    const value_range *range = o->sweep->range;
    char message[DAE_MESSAGE_LENGTH] = "";
    const value_range asked = {.n = o->n_values, .from = range->from, .to = range->to};
    o->values = arena_calloc(&o->arena, (size_t)o->n_values, sizeof *o->values);
    for (int i = 0; i < o->n_values; i++) {
        o->values[i] = value_range_at(&asked, i);
    }
    const model_orbits_setup setup = {.self = o,
                                      .take = take,
                                      .record = record,
                                      .from = range->from,
                                      .to = range->to,
                                      .position = o->position,
                                      .n_values = o->n_values,
                                      .values = o->values};
    o->orbits = model_orbits_create(&setup, value, message);
    return o->orbits != NULL || evl_error_set(error, EVL_EXIT_CASE, "", "%s", message);
}

/** Set the data common to all orbits from the first state. @return false with the reason in `error` */
static bool begin_orbits(branches *o, double value, const state_transfer *state, evl_error *error)
{
    if (!o->has_orbits) {
        o->sizes = state->sizes;
        o->position = state->pitches;
        o->scaled_at = value;
        o->has_orbits = create_orbits(o, value, error);
    }
    return o->has_orbits;
}

/** If the motion does not repeat: find an orbit, stable or not, from the final state of the motion, or from the
 *  quasi-static one.
 *  @param state  becomes the state from which it was found */
static bool find_other_start(branches *o, double value, state_transfer *state, response_point *point, evl_error *error)
{
    static const char *const origins[] = {"its last state", "the quasi-static state"};
    char message[DAE_MESSAGE_LENGTH];
    const char *what = point->period == 0 ? "is not periodic" : "still settles";
    const double time = point->common_time, phase = state->phase;
    for (int origin = 0; origin < 2; origin++) {
        model_orbit orbit;
        if ((origin == 1 &&
             !shortcut_quasi_static(&o->sweep->plan, &o->sweep->period, phase, o->sweep->interrupt, state)) ||
            !begin_orbits(o, value, state, error) ||
            !model_orbits_find(o->orbits, value, 1, time, &state->state, &orbit, message)) {
            continue;
        }
        CLEANUP_FREE char *why = xasprintf("the motion %s: an orbit was found from %s", what, origins[origin]);
        branches_note(o, value, why);
        point->period = 1;
        point->time = orbit.time;
        point->values = branches_metrics(o, &orbit);
        return true;
    }
    CLEANUP_FREE char *why =
        xasprintf("the motion %s, and no orbit was found from its last state or the quasi-static one", what);
    branches_note(o, value, why);
    return false;
}

/** Find the settled motion at a value. */
static orbit_end look(branches *o, double value, evl_error *error)
{
    state_transfer state = {.exists = false};
    response_point point = {.values = arena_calloc(&o->arena, (size_t)o->sweep->n_values, sizeof(double))};
    orbit_end end = branch_look(o->sweep, value, &state, &point, error);
    bool begins = false;
    if (end == ORBIT_FOUND && point.period <= 0 && !find_other_start(o, value, &state, &point, error)) {
        end = error->code == EVL_EXIT_OK ? ORBIT_FOUND : ORBIT_FAILED;
    } else if (end == ORBIT_FOUND && point.period > o->longest) {
        CLEANUP_FREE char *why =
            xasprintf("the motion repeats after %d common periods, more than --longest %d: it is omitted", point.period,
                      o->longest);
        branches_note(o, value, why);
    } else if (end == ORBIT_FOUND) {
        end = begin_orbits(o, value, &state, error) ? ORBIT_FOUND : ORBIT_FAILED;
        if (o->has_orbits && fabs(state.pitches - o->position) > 1e-9) {
            branches_note(o, value, "an event lies on the common section: the motion is omitted");
        } else if (o->has_orbits) {
            begins = point.values == NULL || !branches_pass(o, value, point.period, point.values);
        }
    }
    if (end == ORBIT_FOUND && *o->sweep->interrupt == 0) {
        o->at = point;
        o->doubling = o->n_points;
        o->task = begins ? BRANCHES_RISE : BRANCHES_LOOK;
        o->value += !begins;
        state_transfer_copy(&o->motion, &state);
    }
    state_transfer_free(&state);
    return end;
}

bool branches_are_done(const branches *o)
{
    return o->value == o->sweep->range->n;
}

/** Undo the changes of an interrupted step. Enlarged arrays remain; only the counts are restored. */
static void undo(branches *o, const branches *before, const orbit_branch *last)
{
    o->value = before->value;
    o->task = before->task;
    o->doubling = before->doubling;
    o->is_continuing = before->is_continuing;
    o->progress = before->progress;
    o->n_branches = before->n_branches;
    o->n_points = before->n_points;
    o->n_problems = before->n_problems;
    if (o->n_branches > 0) {
        o->branches[o->n_branches - 1] = *last;
    }
}

orbit_end branches_step(branches *o, evl_error *error)
{
    const double value = value_range_at(o->sweep->range, o->value);
    const branches before = *o;
    const orbit_branch last = o->n_branches > 0 ? o->branches[o->n_branches - 1] : (orbit_branch){.n = 0};
    orbit_end end = ORBIT_FOUND;
    if (o->is_continuing) {
        go_on(o);
    } else if (o->task == BRANCHES_LOOK) {
        end = look(o, value, error);
    } else if (o->task == BRANCHES_DOUBLE) {
        enter_doubling(o);
    } else {
        begin_direction(o, value);
    }
    if (*o->sweep->interrupt != 0) {
        undo(o, &before, &last);
        return ORBIT_INTERRUPTED;
    }
    if (end == ORBIT_FOUND && branches_are_done(o) && o->n_branches == 0) {
        CLEANUP_FREE char *why =
            xasprintf("no orbit was found%s%s", o->n_problems > 0 ? ": " : "", o->n_problems > 0 ? o->problems[0] : "");
        evl_error_set(error, EVL_EXIT_INTEGRATION, "", "%s", why);
        return ORBIT_FAILED;
    }
    return end;
}

bool branches_resume(branches *o, evl_error *error)
{
    char message[DAE_MESSAGE_LENGTH] = "";
    int point = 0;
    if (!o->has_orbits) {
        return true;
    }
    if (!create_orbits(o, o->scaled_at, error)) {
        return false;
    }
    for (int i = 0; i < o->n_branches; i++) {
        if (o->branches[i].n == 0) {
            model_orbits_put(o->orbits, i, NULL);
        }
        for (int k = 0; k < o->branches[i].n; k++) {
            model_orbits_put(o->orbits, i, o->records[point++]);
        }
    }
    return !o->is_continuing || model_orbits_go_on(o->orbits, &o->progress, message) ||
           evl_error_set(error, EVL_EXIT_INTEGRATION, "", "%s", message);
}

void branches_free(branches *o)
{
    state_transfer_free(&o->motion);
    model_orbits_delete(&o->orbits);
    case_plan_free(&o->plan);
    arena_free(&o->arena);
}
