#include "respond/branches_points.h"

#include <math.h>

void branches_note(branches *o, double value, const char *why)
{
    CLEANUP_FREE char *option = value_range_option(o->sweep->range, value);
    CLEANUP_FREE char *text = xasprintf("%s: %s", option, why);
    o->problems =
        arena_grow(&o->arena, o->problems, (size_t)o->n_problems, (size_t)o->n_problems + 1, sizeof *o->problems);
    o->problems[o->n_problems++] = arena_copy(&o->arena, text);
}

/** Index of a parameter among the requested values, bitwise equal; -1: none. */
static int value_index(const branches *o, double parameter)
{
    for (int i = 0; i < o->n_values; i++) {
        if (o->values[i] == parameter) {
            return i;
        }
    }
    return -1;
}

/** Length of a common period on an orbit [s]. */
static double common_time(const model_orbit *orbit)
{
    return orbit->time / orbit->periods;
}

/** Metrics of a point, or of the present orbit if `number` is negative. @return NULL with the reason in `message` */
static double *find_metrics(branches *o, int number, int point, const model_orbit *orbit,
                            char message[DAE_MESSAGE_LENGTH])
{
    dae_state state = dae_state_create(&o->sizes, NULL);
    double *values = arena_calloc(&o->arena, (size_t)o->sweep->n_values, sizeof *values);
    const bool good = model_orbits_state(o->orbits, number, point, &state, message) &&
                      orbit_record(&o->plan, &o->period, &state, orbit->periods, common_time(orbit), orbit->is_stable,
                                   o->sweep->interrupt, NULL, values, message) == ORBIT_FOUND;
    dae_state_free(&state);
    return good ? values : NULL;
}

double *branches_metrics(branches *o, const model_orbit *orbit)
{
    char message[DAE_MESSAGE_LENGTH];
    return find_metrics(o, -1, 0, orbit, message);
}

/** A mesh that is always in contact on both sides of a grazing point does not separate there: one of its tooth pairs
 *  does. */
static void check_grazing(branches *o, int first, int n)
{
    const model_output *row = &o->sweep->rows[METRIC_share_no_contact];
    for (int k = first + 1; k + 1 < first + n; k++) {
        model_orbit *orbit = &o->points[k].orbit;
        const double *before = o->points[k - 1].values, *after = o->points[k + 1].values;
        const bool is_grazing = orbit->kind == MODEL_ORBIT_GRAZING || orbit->kind == MODEL_ORBIT_GRAZING_FOLD;
        if (is_grazing && orbit->mesh >= 0 && before != NULL && after != NULL) {
            const int at = row->offset + orbit->mesh;
            orbit->whole_mesh = orbit->whole_mesh && (before[at] > 0 || after[at] > 0);
        }
    }
}

void branches_take_points(branches *o, int n)
{
    const int number = o->n_branches - 1, n_doubles = 2 * (o->sizes.n + o->sizes.n_reals);
    orbit_branch *branch = &o->branches[number];
    const size_t have = (size_t)o->n_points, want = have + (size_t)(n - branch->n);
    o->points = arena_grow(&o->arena, o->points, have, want, sizeof *o->points);
    o->records = arena_grow(&o->arena, o->records, have, want, sizeof *o->records);
    o->record_length = model_orbits_record_length(o->orbits);
    for (int k = branch->n; k < n; k++) {
        orbit_point *point = &o->points[o->n_points];
        char why[DAE_MESSAGE_LENGTH] = "";
        double **records = &o->records[o->n_points++];
        point->branch = number;
        point->multipliers = arena_calloc(&o->arena, (size_t)n_doubles, sizeof *point->multipliers);
        model_orbits_point(o->orbits, number, k, &point->orbit, point->multipliers);
        *records = arena_calloc(&o->arena, (size_t)o->record_length, sizeof **records);
        model_orbits_save(o->orbits, number, k, *records);
        point->at_value = value_index(o, point->orbit.parameter);
        point->values = point->orbit.recorded >= 0 ? o->recorded[point->orbit.recorded]
                                                   : find_metrics(o, number, k, &point->orbit, why);
        if (point->values == NULL && *o->sweep->interrupt == 0) {
            branches_note(o, point->orbit.parameter, why);
        }
    }
    branch->n = n;
    check_grazing(o, o->n_points - n, n);
}

/** Whether two orbits at one value are the same, judged by their transmission errors. */
static bool are_alike(const branches *o, const double *a, const double *b)
{
    static const double near = 1e-4;
    const model_output *row = &o->sweep->rows[METRIC_transmission_error_standard_deviation];
    for (int i = 0; i < row->count; i++) {
        const double x = a[row->offset + i], y = b[row->offset + i];
        if (!(fabs(x - y) <= near * fmax(fabs(x), fabs(y)))) {
            return false;
        }
    }
    return true;
}

bool branches_pass(branches *o, double value, int periods, const double *values)
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
                const double *metrics = find_metrics(o, -1, 0, &here, message);
                known = metrics != NULL && are_alike(o, metrics, values);
            }
        }
    }
    dae_state_free(&state);
    return known;
}

bool branches_have_entered(const branches *o, const model_orbit *doubling)
{
    static const double near = 1e-3; /* relative to the range */
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

/** Whether orbits on one side of a point may be stable: it is stable itself, or the stability changes there. */
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
