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
                                 o->sweep->interrupt, values, message) == ORBIT_FOUND;
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

/** Follow the branch of the present orbit, and tell its points.
 *  @return ORBIT_INTERRUPTED if a signal came in between */
static orbit_end follow(branches *o, bool rising, int parent)
{
    char message[DAE_MESSAGE_LENGTH] = "";
    const int n_room = 2 * (o->sizes.n + o->sizes.n_reals);
    int n = 0;
    const bool good = model_orbits_follow(o->orbits, rising, &n, message);
    const int number = o->n_branches;
    o->points = pool_grow(&o->pool, o->points, (size_t)o->n_points, (size_t)o->n_points + (size_t)n, sizeof *o->points);
    o->branches =
        pool_grow(&o->pool, o->branches, (size_t)o->n_branches, (size_t)o->n_branches + 1, sizeof *o->branches);
    for (int k = 0; k < n; k++) {
        orbit_point *point = &o->points[o->n_points + k];
        char why[DAE_MESSAGE_LENGTH] = "";
        point->branch = number;
        point->multipliers = pool_calloc(&o->pool, (size_t)n_room, sizeof *point->multipliers);
        model_orbits_point(o->orbits, number, k, &point->orbit, point->multipliers);
        point->at_value = place_among(o, point->orbit.parameter);
        point->values = find_numbers(o, number, k, &point->orbit, why);
        if (point->values == NULL && *o->sweep->interrupt == 0) {
            note_problem(o, point->orbit.parameter, why);
        }
    }
    o->branches[number] = (orbit_branch){.parent = parent, .n = n, .end = good ? "" : pool_copy(&o->pool, message)};
    o->n_branches++;
    o->n_points += n;
    return *o->sweep->interrupt != 0 ? ORBIT_INTERRUPTED : ORBIT_FOUND;
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

/** Enter the branches of twice the period at all doublings, also at those of these. */
static orbit_end follow_doublings(branches *o, int from)
{
    char message[DAE_MESSAGE_LENGTH];
    for (int k = from; k < o->n_points; k++) {
        const orbit_point at = o->points[k];
        int first = 0;
        for (int i = 0; i < at.branch; i++) {
            first += o->branches[i].n;
        }
        if (at.orbit.kind != MODEL_ORBIT_DOUBLING || 2 * at.orbit.periods > ORBIT_LONGEST || is_entered(o, &at.orbit)) {
            continue;
        }
        if (o->n_branches >= MOST_BRANCHES) {
            note_problem(o, at.orbit.parameter, "there are 64 branches: the one of twice the period is not followed");
            return ORBIT_FOUND;
        }
        if (!model_orbits_switch(o->orbits, at.branch, k - first, message)) {
            note_problem(o, at.orbit.parameter, message);
        } else if (follow(o, true, at.branch) == ORBIT_INTERRUPTED) {
            return ORBIT_INTERRUPTED;
        }
    }
    return *o->sweep->interrupt != 0 ? ORBIT_INTERRUPTED : ORBIT_FOUND;
}

/** From a motion that the gearbox comes to at a value. */
static orbit_end begin_at(branches *o, double value, evl_error *error)
{
    const value_range *range = o->sweep->range;
    char message[DAE_MESSAGE_LENGTH] = "";
    carried state = {.exists = false};
    model_orbit orbit;
    response_point point = {.values = pool_calloc(&o->pool, (size_t)o->sweep->n_values, sizeof(double))};
    orbit_end end = branch_look(o->sweep, value, &state, &point, error);
    if (end == ORBIT_FOUND && point.period == 0) {
        note_problem(o, value, "the motion is not periodic");
    } else if (end == ORBIT_FOUND) {
        if (o->orbits == NULL) {
            const model_orbits_setup setup = {.self = o,
                                              .take = take,
                                              .from = range->from,
                                              .to = range->to,
                                              .place = state.pitches,
                                              .n_values = o->n_values,
                                              .values = o->values};
            o->sizes = state.sizes;
            o->place = state.pitches;
            o->orbits = model_orbits_create(&setup, value, message);
        }
        if (o->orbits == NULL) {
            evl_error_set(error, EVL_EXIT_CASE, "", "%s", message);
            end = *o->sweep->interrupt != 0 ? ORBIT_INTERRUPTED : ORBIT_FAILED;
        } else if (fabs(state.pitches - o->place) > 1e-9) {
            note_problem(o, value, "an event lies on the section of the others: the motion is left out");
        } else if (!is_known(o, value, point.period, point.values)) {
            const int from = o->n_points;
            const bool rises[] = {true, false};
            const double last[] = {fmax(range->from, range->to), fmin(range->from, range->to)};
            for (int i = 0; i < 2 && end == ORBIT_FOUND; i++) {
                if (value == last[i]) {
                    continue;
                }
                if (model_orbits_find(o->orbits, value, point.period, point.time, &state.state, &orbit, message)) {
                    end = follow(o, rises[i], -1);
                } else {
                    note_problem(o, value, message);
                    break;
                }
            }
            end = end == ORBIT_FOUND ? follow_doublings(o, from) : end;
        }
    }
    carried_free(&state);
    return end;
}

orbit_end branches_find(branches *o, evl_error *error)
{
    const value_range *range = o->sweep->range;
    const value_range asked = {.n = o->n_values, .from = range->from, .to = range->to};
    orbit_end end = ORBIT_FOUND;
    o->values = pool_calloc(&o->pool, (size_t)o->n_values, sizeof *o->values);
    for (int i = 0; i < o->n_values; i++) {
        o->values[i] = value_range_at(&asked, i);
    }
    for (int i = 0; i < range->n && end == ORBIT_FOUND; i++) {
        const double value = value_range_at(range, i);
        OWNED char *option = value_range_option(range, value);
        o->told(o->self, option);
        end = begin_at(o, value, error);
    }
    if (end == ORBIT_FOUND && o->n_branches == 0) {
        OWNED char *why =
            xasprintf("no orbit was found%s%s", o->n_problems > 0 ? ": " : "", o->n_problems > 0 ? o->problems[0] : "");
        evl_error_set(error, EVL_EXIT_INTEGRATION, "", "%s", why);
        return ORBIT_FAILED;
    }
    return end;
}

void branches_free(branches *o)
{
    model_orbits_delete(&o->orbits);
    prepared_case_free(&o->prepared);
    pool_free(&o->pool);
}
