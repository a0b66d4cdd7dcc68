#include "respond/section.h"

#include "base/secant.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { FEW_EVENTS = 64, MOST_EVENTS = 4096, MOST_MOVES = 32 };
static const double near = 1e-6; /* pitches */

static double pitch_time(const section *s)
{
    return s->period.time / s->period.pitches;
}

double section_position(const section *s, const dae_state *state)
{
    const dae *dae = &model_about(s->model)->dae;
    return s->period.by_time ? state->t / pitch_time(s) : dae->position(dae->self, s->position_of, state);
}

/** Set the target to the first position of the section behind another position. */
static void aim(section *s, double position)
{
    const double length = s->period.pitches;
    s->target = s->phase + length * (floor((position - s->phase + near) / length) + 1);
}

void section_begin(section *s, memory_arena *arena, const model *model, const model_period *period, double phase,
                   const dae_state *state)
{
    *s = (section){.model = model,
                   .period = *period,
                   .position_of = model_position_of(model, -1, 0),
                   .phase = phase,
                   .here = NAN,
                   .event = NAN,
                   .scratch = dae_state_create(&model_about(model)->dae, arena)};
    s->arena = arena;
    s->capacity = FEW_EVENTS;
    s->now = arena_calloc(arena, FEW_EVENTS, sizeof *s->now);
    s->before = arena_calloc(arena, FEW_EVENTS, sizeof *s->before);
    aim(s, section_position(s, state));
}

double section_pitch_rate(const section *s, const dae_state *state)
{
    static const double instant = 1e-6;
    const dae *dae = &model_about(s->model)->dae;
    CLEANUP_FREE double *y = xcalloc((size_t)dae->n, sizeof *y);
    const dae_state later = {.integers = state->integers, .y = y};
    for (int i = 0; i < dae->n; i++) {
        y[i] = state->y[i] + instant * state->yp[i];
    }
    return (dae->position(dae->self, s->position_of, &later) - dae->position(dae->self, s->position_of, state)) /
           instant;
}

typedef struct {
    section *section;
    const integrate_step *step;
} crossing;

/** Distance of the position at t in a step from the target. */
static double past(void *of, double t)
{
    const crossing *crossing = of;
    section *s = crossing->section;
    s->scratch.t = t;
    s->scratch.integers = crossing->step->state->integers;
    return crossing->step->interpolate(crossing->step->with, t, s->scratch.y)
               ? section_position(s, &s->scratch) - s->target
               : NAN;
}

/** Time at which an angle reaches the target, in a step that does. */
static double time_of(section *s, const integrate_step *step)
{
    static const double close = 1e-13;
    crossing crossing = {s, step};
    return secant_zero(past, &crossing, step->t_from, past(&crossing, step->t_from), step->t_to,
                       past(&crossing, step->t_to), close);
}

bool section_reached(section *s, const integrate_step *step, dae_state *state)
{
    const dae *dae = &model_about(s->model)->dae;
    double t = s->target * (s->period.by_time ? pitch_time(s) : 1);
    if (s->period.by_time ? t > step->t_to || t < step->t_from : !(section_position(s, step->state) >= s->target)) {
        return false;
    }
    t = s->period.by_time ? t : time_of(s, step);
    dae_state_copy(dae, state, step->state);
    state->t = t;
    return step->interpolate(step->with, t, state->y);
}

/** An event is at the section if it is at most this far from it. */
static void look(section *s)
{
    s->is_crossed = s->is_crossed || fabs(s->here - s->event) <= near;
}

void section_passed(section *s)
{
    double *other = s->before;
    s->before = s->now;
    s->n_before = s->n_now;
    s->now = other;
    s->n_now = 0;
    s->here = s->target;
    s->target += s->period.pitches;
    look(s);
}

void section_event(section *s, const event_record *record)
{
    const double length = s->period.pitches;
    s->event = section_position(s, record->before);
    if (s->n_now == s->capacity && s->capacity < MOST_EVENTS) {
        const size_t n = (size_t)s->capacity;
        s->capacity *= 4;
        s->now = arena_grow(s->arena, s->now, n, (size_t)s->capacity, sizeof *s->now);
        s->before = arena_grow(s->arena, s->before, n, (size_t)s->capacity, sizeof *s->before);
    }
    if (s->n_now < s->capacity) {
        s->now[s->n_now++] = s->event - length * floor(s->event / length);
    }
    look(s);
}

static int compare(const void *a, const void *b)
{
    const double *x = a, *y = b;
    return (*x > *y) - (*x < *y);
}

bool section_moves(section *s)
{
    const double length = s->period.pitches;
    const int n = s->n_now + s->n_before;
    if (!s->is_crossed || n == 0 || s->n_moves == MOST_MOVES) {
        s->is_crossed = false;
        return false;
    }
    CLEANUP_FREE double *positions = xcalloc((size_t)n + 1, sizeof *positions);
    memcpy(positions, s->now, (size_t)s->n_now * sizeof *positions);
    memcpy(positions + s->n_now, s->before, (size_t)s->n_before * sizeof *positions);
    qsort(positions, (size_t)n, sizeof *positions, compare);
    positions[n] = positions[0] + length;
    double widest = 0;
    for (int i = 0; i < n; i++) {
        const double gap = positions[i + 1] - positions[i];
        if (gap > widest) {
            widest = gap;
            s->phase = fmod(positions[i] + 0.5 * gap, length);
        }
    }
    aim(s, s->event);
    s->here = NAN;
    s->is_crossed = false;
    s->n_moves++;
    return true;
}
