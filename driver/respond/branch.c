#include "respond/branch.h"
#include "simulate/case_start.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Criterion for a jump of the motion: the standard deviations of the transmission errors of two neighbouring motions. */

/** Number of times that the interval between two values is halved. */
enum { JUMP_HALVINGS = 10 };
/** Part of a difference that must remain then. A motion that changes smoothly has 0.001 of it, a square-root
 *  bifurcation 0.03. */
#define JUMP_STAYS 0.5
static const double small = 0.05; /* differences below it are not regarded as a jump */

/** Largest relative difference of a metric over the meshes, relative to the larger value. @param row  the metric */
static double jump_size(const model_output *row, const response_point *a, const response_point *b)
{
    double size = 0;
    for (int i = row->offset; i < row->offset + row->count; i++) {
        const double larger = fmax(fabs(a->values[i]), fabs(b->values[i]));
        size = larger > 0 ? fmax(size, fabs(a->values[i] - b->values[i]) / larger) : size;
    }
    return size;
}

/** Whether to refine the interval between two values. */
static bool jump_is_likely(const model_output *row, const response_point *a, const response_point *b)
{
    const bool either_repeats = a->period > 0 || b->period > 0;
    const bool both_are_known = a->period >= 0 && b->period >= 0; /* a motion that is not settled is not assigned to any
                                                                   * branch yet */
    return either_repeats && both_are_known && jump_size(row, a, b) > small;
}

branch_cursor branch_at(const branch *b, int step)
{
    const int n = b->range->n;
    const int direction = b->goes[0] && step < n ? 0 : 1;
    const int k = step - (b->goes[0] && direction == 1 ? n : 0);
    return (branch_cursor){direction, direction == 0 ? k : n - 1 - k, k == 0};
}

bool branch_plan_into(const branch *b, case_plan *plan, double value, model_period *period, evl_error *error)
{
    ARENA_SCOPE memory_arena arena = {NULL};
    CLEANUP_FREE char *option = value_range_option(b->range, value);
    const char **set = arena_calloc(&arena, (size_t)b->n_set + 1, sizeof *set);
    for (int i = 0; i < b->n_set; i++) {
        set[i] = b->set[i];
    }
    set[b->n_set] = option;
    const plan_request request = {
        .base = b->base, .n_set = b->n_set + 1, .set = set, .wheels = wheel_store_door(b->wheels)};
    if (!case_plan_make(plan, &request, error)) {
        return false;
    }
    model_message refusal;
    if (model_about(plan->model)->dae.stepper == NULL) {
        model_explain_no_stepper(plan->model, &refusal);
        return case_plan_refuse(plan, &refusal, error);
    }
    if (!model_find_period(plan->model, period, &refusal)) {
        return case_plan_refuse(plan, &refusal, error);
    }
    if (period->sense < 0) {
        return evl_error_set(error, EVL_EXIT_CASE, option,
                             "the wheels turn against driving_rotation, but metrics count pitches in its sense; give "
                             "the other rotation");
    }
    return true;
}

bool branch_plan(branch *b, double value, model_period *period, evl_error *error)
{
    return branch_plan_into(b, &b->plan, value, period, error);
}

/** Initial state of the motion at a value: the case's own, or the one transferred from the previous value. */
static bool start(branch *b, const model_period *period, state_transfer *state, char *message, evl_error *error)
{
    const dae *dae = &model_about(b->plan.model)->dae;
    if (!state->exists) {
        *state = (state_transfer){.sizes = *dae, .phase = SECTION_USUAL_PHASE};
        state->exists = case_start(&b->plan, b->interrupt, &state->state, NULL, error);
        return state->exists;
    }
    state_transfer next = {.exists = true, .sizes = *dae, .phase = state->phase};
    next.state = dae_state_create(dae, NULL);
    const double t = period->by_time ? state->pitches * period->time / period->pitches : 0;
    const bool good = model_take_over(b->plan.model, &state->sizes, &state->state, t, &next.state, message);
    state_transfer_free(state);
    *state = next;
    return good;
}

orbit_end branch_look(branch *b, double value, state_transfer *state, response_point *point, evl_error *error)
{
    char message[DAE_MESSAGE_LENGTH] = "";
    orbit_result result;
    error->code = EVL_EXIT_OK;
    if (!branch_plan(b, value, &b->period, error)) {
        return ORBIT_FAILED;
    }
    orbit_end end = start(b, &b->period, state, message, error) ? ORBIT_FOUND : ORBIT_FAILED;
    if (end == ORBIT_FOUND) {
        end = orbit_find(&b->plan, &b->period, state, b->most, b->interrupt, &result, point->values, message);
    }
    if (end == ORBIT_FOUND) {
        point->period = result.period;
        point->periods = result.periods;
        point->pitches = result.pitches;
        point->distance = result.distance;
        point->time = result.time;
        point->common_time = result.common_time;
        point->time_constant = result.time_constant;
    } else if (end == ORBIT_FAILED && error->code == EVL_EXIT_OK) {
        CLEANUP_FREE char *option = value_range_option(b->range, value);
        evl_error_set(error, EVL_EXIT_INTEGRATION, option, "%s", message);
    }
    return end;
}

/* ---- jumps ---- */

static double *deviations(branch *b, const response_point *point)
{
    const model_output *row = &b->rows[METRIC_transmission_error_standard_deviation];
    double *copy = arena_calloc(&b->arena, (size_t)row->count, sizeof *copy);
    return memcpy(copy, point->values + row->offset, (size_t)row->count * sizeof *copy);
}

static void add_jump(branch *b, int direction, const double values[2], const response_point points[2])
{
    b->jumps = arena_grow(&b->arena, b->jumps, (size_t)b->n_jumps, (size_t)b->n_jumps + 1, sizeof *b->jumps);
    b->jumps[b->n_jumps++] = (response_jump){.direction = direction,
                                             .before = values[0],
                                             .after = values[1],
                                             .period_before = points[0].period,
                                             .period_after = points[1].period,
                                             .deviation_before = deviations(b, &points[0]),
                                             .deviation_after = deviations(b, &points[1])};
}

/** An interval between two values, and the motions at its ends. */
typedef struct {
    double values[2];
    response_point points[2];
    state_transfer state; /**< of the first */
} gap;

/** Bisect the interval between two values, continuing the motion of the first, until it shows that there is no jump.
 *  @param size  initial difference of the motions; *jumps: it remains */
static orbit_end halve(branch *b, gap *gap, double size, bool *jumps, evl_error *error)
{
    const model_output *row = &b->rows[METRIC_transmission_error_standard_deviation];
    state_transfer trial = {.exists = false};
    orbit_end end = ORBIT_FOUND;
    *jumps = true;
    for (int i = 0; i < JUMP_HALVINGS && *jumps && end == ORBIT_FOUND; i++) {
        const double middle = 0.5 * (gap->values[0] + gap->values[1]);
        response_point between = {.values = arena_calloc(&b->arena, (size_t)b->n_values, sizeof(double))};
        state_transfer_copy(&trial, &gap->state);
        end = branch_look(b, middle, &trial, &between, error);
        if (end == ORBIT_FOUND) {
            const int side = jump_size(row, &gap->points[0], &between) > jump_size(row, &between, &gap->points[1]);
            gap->values[side] = middle;
            gap->points[side] = between;
            if (side == 0) {
                state_transfer_copy(&gap->state, &trial);
            }
            *jumps = jump_size(row, &gap->points[0], &gap->points[1]) >= JUMP_STAYS * size;
        }
    }
    state_transfer_free(&trial);
    return end;
}

/** Examine the interval between the last value and this one, where the motion differs. If the motion can be continued
 *  past a jump in small steps, the jump was caused by the step size: then it is continued further. @param point, state
 *  of the motion at this value */
static orbit_end look_between(branch *b, double last, const response_point *before, double value, response_point *point,
                              state_transfer *state, evl_error *error)
{
    enum { MOST_ROUNDS = 24 };
    const model_output *row = &b->rows[METRIC_transmission_error_standard_deviation];
    gap gap = {.values = {last, value}, .points = {*before, *point}};
    bool jumps = true;
    state_transfer_copy(&gap.state, &b->state);
    orbit_end end = ORBIT_FOUND;
    for (int round = 0; round < MOST_ROUNDS && end == ORBIT_FOUND && jumps; round++) {
        const double size = jump_size(row, &gap.points[0], &gap.points[1]);
        response_point again = {.values = arena_calloc(&b->arena, (size_t)b->n_values, sizeof(double))};
        state_transfer trial = {.exists = false};
        end = halve(b, &gap, size, &jumps, error);
        state_transfer_copy(&trial, &gap.state);
        end = end == ORBIT_FOUND && jumps ? branch_look(b, gap.values[1], &trial, &again, error) : end;
        const bool is_thrown =
            end == ORBIT_FOUND && jumps && jump_size(row, &gap.points[0], &again) < JUMP_STAYS * size;
        if (is_thrown) {
            state_transfer_copy(&gap.state, &trial);
            gap.points[0] = again;
            jumps = gap.values[1] != value;
            if (!jumps) {
                *point = again;
                state_transfer_copy(state, &trial);
            }
            gap.values[0] = gap.values[1];
            gap.values[1] = value;
            gap.points[1] = *point;
        }
        state_transfer_free(&trial);
        if (!is_thrown) {
            break;
        }
    }
    const bool settle = gap.points[0].period == RESPONSE_SETTLING || gap.points[1].period == RESPONSE_SETTLING;
    if (end == ORBIT_FOUND && jumps && !settle) {
        add_jump(b, branch_at(b, b->step).direction, gap.values, gap.points);
    }
    state_transfer_free(&gap.state);
    return end;
}

orbit_end branch_step(branch *b, evl_error *error)
{
    const branch_cursor at = branch_at(b, b->step);
    const double value = value_range_at(b->range, at.index);
    const model_output *row = &b->rows[METRIC_transmission_error_standard_deviation];
    response_point point = {.values = arena_calloc(&b->arena, (size_t)b->n_values, sizeof(double))};
    state_transfer state = {.exists = false};
    state_transfer_copy(&state, &b->state);
    orbit_end end = branch_look(b, value, &state, &point, error);
    if (end == ORBIT_FOUND && !at.begins) {
        const branch_cursor last = branch_at(b, b->step - 1);
        const response_point *before = &b->points[last.direction][last.index];
        if (jump_is_likely(row, before, &point)) {
            end = look_between(b, value_range_at(b->range, last.index), before, value, &point, &state, error);
        }
    }
    if (end == ORBIT_FOUND) {
        b->points[at.direction][at.index] = point;
        state_transfer_copy(&b->state, &state);
        b->step++;
    }
    state_transfer_free(&state);
    return end;
}

/* ---- serialisation ---- */

static void serialize_point(branch *b, response_point *point, archive *archive)
{
    if (archive->is_reading) {
        point->values = arena_calloc(&b->arena, (size_t)b->n_values, sizeof(double));
    }
    SERIALIZE(archive, point->period);
    SERIALIZE(archive, point->periods);
    SERIALIZE(archive, point->pitches);
    SERIALIZE(archive, point->distance);
    SERIALIZE(archive, point->common_time);
    SERIALIZE(archive, point->time_constant);
    SERIALIZE_ARRAY(archive, point->values, b->n_values);
}

static void serialize_jump(branch *b, response_jump *jump, archive *archive)
{
    const int n = b->names->meshes.n;
    if (archive->is_reading) {
        jump->deviation_before = arena_calloc(&b->arena, (size_t)n, sizeof(double));
        jump->deviation_after = arena_calloc(&b->arena, (size_t)n, sizeof(double));
    }
    SERIALIZE(archive, jump->direction);
    SERIALIZE(archive, jump->before);
    SERIALIZE(archive, jump->after);
    SERIALIZE(archive, jump->period_before);
    SERIALIZE(archive, jump->period_after);
    SERIALIZE_ARRAY(archive, jump->deviation_before, n);
    SERIALIZE_ARRAY(archive, jump->deviation_after, n);
}

void branch_serialize(branch *b, archive *archive)
{
    int n_steps = b->n_steps, n_values = b->n_values;
    SERIALIZE(archive, n_steps);
    SERIALIZE(archive, n_values);
    SERIALIZE(archive, b->step);
    SERIALIZE(archive, b->n_jumps);
    archive->has_failed = archive->has_failed || n_steps != b->n_steps || n_values != b->n_values || b->step < 0 ||
                          b->step > b->n_steps || b->n_jumps < 0 || b->n_jumps > b->step;
    if (archive->has_failed) {
        b->step = b->n_jumps = 0;
        return;
    }
    if (archive->is_reading) {
        b->jumps = arena_calloc(&b->arena, (size_t)b->n_jumps + 1, sizeof *b->jumps);
    }
    for (int i = 0; i < b->step; i++) {
        const branch_cursor at = branch_at(b, i);
        serialize_point(b, &b->points[at.direction][at.index], archive);
    }
    for (int i = 0; i < b->n_jumps; i++) {
        serialize_jump(b, &b->jumps[i], archive);
    }
    state_transfer_serialize(&b->state, archive);
}

void branch_free(branch *b)
{
    state_transfer_free(&b->state);
    case_plan_free(&b->plan);
    wheel_store_delete(&b->wheels);
    case_base_delete(&b->base);
    arena_free(&b->arena);
}
