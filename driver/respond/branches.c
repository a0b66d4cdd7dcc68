#include "respond/branches.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { MOST_BRANCHES = 64 };

/** A model for the kernel. */
static const model *take(void *self, double value, char message[DAE_MESSAGE_LENGTH])
{
    branches *o = self;
    evl_error error = {.code = EVL_EXIT_OK};
    if (*o->sweep->interrupt != 0) {
        (void)snprintf(message, DAE_MESSAGE_LENGTH, "interrupted");
        return NULL;
    }
    if (!branch_prepare_as(o->sweep, &o->prepared, value, &o->period, &error)) {
        (void)snprintf(message, DAE_MESSAGE_LENGTH, "%.390s", error.message);
        return NULL;
    }
    return o->prepared.model;
}

/** The numbers of what is to be an orbit, for the kernel, which sees where it came. */
static bool tell(void *self, int number, int periods, double *time, dae_state *state)
{
    branches *o = self;
    char message[DAE_MESSAGE_LENGTH];
    if (number >= o->n_told) {
        o->told = pool_grow(&o->pool, o->told, (size_t)o->n_told, (size_t)number + 1, sizeof *o->told);
        for (; o->n_told <= number; o->n_told++) {
            o->told[o->n_told] = NULL;
        }
    }
    if (o->told[number] == NULL) {
        o->told[number] = pool_calloc(&o->pool, (size_t)o->sweep->n_values, sizeof(double));
    }
    const double began = state->t;
    const bool good = orbit_tell(&o->prepared, &o->period, state, periods, *time / periods, o->sweep->interrupt, state,
                                 o->told[number], message) == ORBIT_FOUND;
    *time = o->period.by_time ? *time : state->t - began;
    return good;
}

/** Which of the values that are asked for a parameter is, bit for bit; -1: none. */
static int place_among(const branches *o, double parameter)
{
    for (int i = 0; i < o->n_values; i++) {
        if (o->values[i] == parameter) {
            return i;
        }
    }
    return -1;
}

/** Remember that something did not come to an orbit. */
static void note_problem(branches *o, double value, const char *why)
{
    OWNED char *option = value_range_option(o->sweep->range, value);
    OWNED char *text = xasprintf("%s: %s", option, why);
    o->problems =
        pool_grow(&o->pool, o->problems, (size_t)o->n_problems, (size_t)o->n_problems + 1, sizeof *o->problems);
    o->problems[o->n_problems++] = pool_copy(&o->pool, text);
}

/** Length of a common period on an orbit [s]. */
static double common_time(const model_orbit *orbit)
{
    return orbit->time / orbit->periods;
}

/** The numbers of a point, or of the present orbit if `number` is negative. @return NULL with the reason in `message` */
static double *find_numbers(branches *o, int number, int point, const model_orbit *orbit,
                            char message[DAE_MESSAGE_LENGTH])
{
    dae_state state = dae_state_create(&o->sizes, NULL);
    double *values = pool_calloc(&o->pool, (size_t)o->sweep->n_values, sizeof *values);
    const bool good = model_orbits_state(o->orbits, number, point, &state, message) &&
                      orbit_tell(&o->prepared, &o->period, &state, orbit->periods, common_time(orbit),
                                 o->sweep->interrupt, NULL, values, message) == ORBIT_FOUND;
    dae_state_free(&state);
    return good ? values : NULL;
}

/** Whether two orbits at one value are the same: their transmission errors are. */
static bool are_alike(const branches *o, const double *a, const double *b)
{
    static const double near = 1e-4;
    const model_output *row = &o->sweep->rows[number_row(NUMBER_ERROR, TELLS_DEVIATION)];
    for (int i = 0; i < row->count; i++) {
        const double x = a[row->offset + i], y = b[row->offset + i];
        if (!(fabs(x - y) <= near * fmax(fabs(x), fabs(y)))) {
            return false;
        }
    }
    return true;
}

/** Whether a branch passes an orbit that has these numbers. */
static bool is_known(branches *o, double value, int periods, const double *values)
{
    char message[DAE_MESSAGE_LENGTH];
    dae_state state = dae_state_create(&o->sizes, NULL);
    bool known = false;
    int first = 0;
    for (int i = 0; i < o->n_branches && !known; first += o->branches[i++].n) {
        for (int k = 0; k + 1 < o->branches[i].n && !known; k++) {
            const model_orbit *a = &o->points[first + k].orbit, *b = &o->points[first + k + 1].orbit;
            if (a->periods != periods || (a->parameter - value) * (b->parameter - value) > 0) {
                continue;
            }
            model_orbit here;
            const int nearer = fabs(a->parameter - value) < fabs(b->parameter - value) ? k : k + 1;
            const model_orbit *near = &o->points[first + nearer].orbit;
            if (model_orbits_state(o->orbits, i, nearer, &state, message) &&
                model_orbits_find(o->orbits, value, periods, near->time, &state, &here, message)) {
                const double *numbers = find_numbers(o, -1, 0, &here, message);
                known = numbers != NULL && are_alike(o, numbers, values);
            }
        }
    }
    dae_state_free(&state);
    return known;
}

/** Tell the points that the last branch has gained, and keep what the kernel needs of them. */
static void take_points(branches *o, int n)
{
    const int number = o->n_branches - 1, n_room = 2 * (o->sizes.n + o->sizes.n_reals);
    orbit_branch *branch = &o->branches[number];
    const size_t have = (size_t)o->n_points, want = have + (size_t)(n - branch->n);
    o->points = pool_grow(&o->pool, o->points, have, want, sizeof *o->points);
    o->kept = pool_grow(&o->pool, o->kept, have, want, sizeof *o->kept);
    o->n_kept = model_orbits_kept(o->orbits);
    for (int k = branch->n; k < n; k++) {
        orbit_point *point = &o->points[o->n_points];
        char why[DAE_MESSAGE_LENGTH] = "";
        double **kept = &o->kept[o->n_points++];
        point->branch = number;
        point->multipliers = pool_calloc(&o->pool, (size_t)n_room, sizeof *point->multipliers);
        model_orbits_point(o->orbits, number, k, &point->orbit, point->multipliers);
        *kept = pool_calloc(&o->pool, (size_t)o->n_kept, sizeof **kept);
        model_orbits_keep(o->orbits, number, k, *kept);
        point->at_value = place_among(o, point->orbit.parameter);
        point->values =
            point->orbit.told >= 0 ? o->told[point->orbit.told] : find_numbers(o, number, k, &point->orbit, why);
        if (point->values == NULL && *o->sweep->interrupt == 0) {
            note_problem(o, point->orbit.parameter, why);
        }
    }
    branch->n = n;
}

/** Begin the branch of the present orbit. */
static void begin_branch(branches *o, bool rising, int parent)
{
    char message[DAE_MESSAGE_LENGTH] = "";
    int n = 0;
    o->is_under_way = model_orbits_begin(o->orbits, rising, &n, message);
    const size_t have = (size_t)o->n_branches;
    o->branches = pool_grow(&o->pool, o->branches, have, have + 1, sizeof *o->branches);
    o->branches[o->n_branches++] = (orbit_branch){.parent = parent, .end = pool_copy(&o->pool, message)};
    take_points(o, n);
    o->progress = model_orbits_walk(o->orbits);
}

/** The next point of the branch. */
static void go_on(branches *o)
{
    char message[DAE_MESSAGE_LENGTH] = "";
    bool is_over = false;
    int n = 0;
    o->n_told = 0;
    const bool good = model_orbits_advance(o->orbits, &n, &is_over, message);
    if (*o->sweep->interrupt != 0) {
        return;
    }
    take_points(o, n);
    o->branches[o->n_branches - 1].end = pool_copy(&o->pool, message);
    o->is_under_way = good && !is_over;
    o->progress = model_orbits_walk(o->orbits);
}

/** Whether a branch of twice the period begins or ends at a doubling. */
static bool is_entered(const branches *o, const model_orbit *doubling)
{
    static const double near = 1e-3; /* of the range */
    const double range = fabs(o->sweep->range->to - o->sweep->range->from);
    int first = 0;
    for (int i = 0; i < o->n_branches; first += o->branches[i++].n) {
        for (int k = 0; k < o->branches[i].n; k += o->branches[i].n - 1 > 0 ? o->branches[i].n - 1 : 1) {
            const model_orbit *end = &o->points[first + k].orbit;
            if (end->periods == 2 * doubling->periods && fabs(end->parameter - doubling->parameter) < near * range) {
                return true;
            }
        }
    }
    return false;
}

/** Enter the next branch of twice the period, also at doublings of such ones. When there is none left the value is done. */
static void enter_doubling(branches *o)
{
    char message[DAE_MESSAGE_LENGTH];
    while (o->doubling < o->n_points && !o->is_under_way) {
        const orbit_point at = o->points[o->doubling];
        int first = 0;
        for (int i = 0; i < at.branch; i++) {
            first += o->branches[i].n;
        }
        const int point = o->doubling++ - first;
        if (at.orbit.kind != MODEL_ORBIT_DOUBLING || 2 * at.orbit.periods > o->longest || is_entered(o, &at.orbit)) {
            continue;
        }
        if (o->n_branches >= MOST_BRANCHES) {
            note_problem(o, at.orbit.parameter, "there are 64 branches: the one of twice the period is not followed");
            o->doubling = o->n_points;
        } else if (!model_orbits_switch(o->orbits, at.branch, point, message)) {
            note_problem(o, at.orbit.parameter, message);
        } else {
            begin_branch(o, true, at.branch);
        }
    }
    if (!o->is_under_way) {
        o->task = BRANCHES_LOOK;
        o->value++;
    }
}

/** Begin the branch of the motion of a value, unless that is the end of the range to which it would go. */
static void begin_way(branches *o, double value)
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
        note_problem(o, value, message);
        o->task = BRANCHES_DOUBLE;
    }
}

/** What finds orbits, with the section where the first motion has it. */
static bool create_orbits(branches *o, double value, evl_error *error)
{
    const value_range *range = o->sweep->range;
    char message[DAE_MESSAGE_LENGTH] = "";
    const value_range asked = {.n = o->n_values, .from = range->from, .to = range->to};
    o->values = pool_calloc(&o->pool, (size_t)o->n_values, sizeof *o->values);
    for (int i = 0; i < o->n_values; i++) {
        o->values[i] = value_range_at(&asked, i);
    }
    const model_orbits_setup setup = {.self = o,
                                      .take = take,
                                      .tell = tell,
                                      .from = range->from,
                                      .to = range->to,
                                      .place = o->place,
                                      .n_values = o->n_values,
                                      .values = o->values};
    o->orbits = model_orbits_create(&setup, value, message);
    return o->orbits != NULL || evl_error_set(error, EVL_EXIT_CASE, "", "%s", message);
}

/** Find the motion to which the gearbox comes at a value. */
static orbit_end look(branches *o, double value, evl_error *error)
{
    carried state = {.exists = false};
    response_point point = {.values = pool_calloc(&o->pool, (size_t)o->sweep->n_values, sizeof(double))};
    orbit_end end = branch_look(o->sweep, value, &state, &point, error);
    bool begins = false;
    if (end == ORBIT_FOUND && point.period == 0) {
        note_problem(o, value, "the motion is not periodic");
    } else if (end == ORBIT_FOUND && point.period > o->longest) {
        OWNED char *why =
            xasprintf("the motion repeats after %d common periods, more than --longest %d: it is left out",
                      point.period, o->longest);
        note_problem(o, value, why);
    } else if (end == ORBIT_FOUND) {
        if (!o->has_orbits) {
            o->sizes = state.sizes;
            o->place = state.pitches;
            o->scaled_at = value;
            o->has_orbits = create_orbits(o, value, error);
            end = o->has_orbits ? ORBIT_FOUND : ORBIT_FAILED;
        }
        if (o->has_orbits && fabs(state.pitches - o->place) > 1e-9) {
            note_problem(o, value, "an event lies on the section of the others: the motion is left out");
        } else if (o->has_orbits) {
            begins = !is_known(o, value, point.period, point.values);
        }
    }
    if (end == ORBIT_FOUND && *o->sweep->interrupt == 0) {
        o->at = point;
        o->doubling = o->n_points;
        o->task = begins ? BRANCHES_RISE : BRANCHES_LOOK;
        o->value += !begins;
        carried_copy(&o->motion, &state);
    }
    carried_free(&state);
    return end;
}

bool branches_are_done(const branches *o)
{
    return o->value == o->sweep->range->n;
}

/** Whether orbits on one side of a point may be stable: it is itself, or its stability changes there. */
static bool may_be_stable(const orbit_point *point)
{
    return point->orbit.is_stable || point->orbit.kind != MODEL_ORBIT_ORDINARY;
}

int branches_left_out(const branches *o, int branch, double *first)
{
    int begin = 0, n = 0;
    for (int i = 0; i < branch; i++) {
        begin += o->branches[i].n;
    }
    for (int k = begin; k + 1 < begin + o->branches[branch].n; k++) {
        const orbit_point *a = &o->points[k], *b = &o->points[k + 1];
        const bool is_stable = (a->orbit.is_stable || b->orbit.is_stable) && may_be_stable(a) && may_be_stable(b);
        for (int i = 0; i < o->n_values && is_stable; i++) {
            if ((o->values[i] - a->orbit.parameter) * (o->values[i] - b->orbit.parameter) < 0) {
                *first = n++ == 0 ? o->values[i] : *first;
            }
        }
    }
    return n;
}

/** Put back what a step that was interrupted has changed. What has grown stays as it is: only the counts count. */
static void undo(branches *o, const branches *before, const orbit_branch *last)
{
    o->value = before->value;
    o->task = before->task;
    o->doubling = before->doubling;
    o->is_under_way = before->is_under_way;
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
    if (o->is_under_way) {
        go_on(o);
    } else if (o->task == BRANCHES_LOOK) {
        end = look(o, value, error);
    } else if (o->task == BRANCHES_DOUBLE) {
        enter_doubling(o);
    } else {
        begin_way(o, value);
    }
    if (*o->sweep->interrupt != 0) {
        undo(o, &before, &last);
        return ORBIT_INTERRUPTED;
    }
    if (end == ORBIT_FOUND && branches_are_done(o) && o->n_branches == 0) {
        OWNED char *why =
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
            model_orbits_put(o->orbits, i, o->kept[point++]);
        }
    }
    return !o->is_under_way || model_orbits_go_on(o->orbits, &o->progress, message) ||
           evl_error_set(error, EVL_EXIT_INTEGRATION, "", "%s", message);
}

void branches_free(branches *o)
{
    carried_free(&o->motion);
    model_orbits_delete(&o->orbits);
    prepared_case_free(&o->prepared);
    pool_free(&o->pool);
}
