#include "simulate/metrics.h"

#include "base/memory.h"
#include "base/secant.h"
#include "base/words.h"
#include "simulate/metric_sums.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static const double two_pi = 6.283185307179586;

struct metrics {
    memory_arena arena;
    const model *model;
    metric_window window;
    metric_sums sums;
    model_sampler *angles;  /**< of all wheels, at one state */
    double *y, *values;     /**< of one state */
    int closed, impact;     /**< event kinds */
    bool is_set_up;         /**< constants are set */
    bool has_started;       /**< the window has started */
    double sense;           /**< of the window's wheel: pitches or revolutions per radian, with sign */
    double start_position;  /**< position at the angle 0 */
    double first, next;     /**< position at the start of the window; at the end of the present period */
    double t_first, t_last; /**< start and end of the complete periods */
    double position;        /**< largest position reached */
    double first_seen;      /**< first position in the window */
    long periods;
    dae_state start; /**< of the run */
    bool has_start, starts_periodic;
    settled_result settled;
};

static int event_kind(const char *name)
{
    return words_index(name, model_tables()->n_event_kinds, model_tables()->event_kinds);
}

metrics *metrics_create(const model *model, const metric_window *window, const bool *taken)
{
    const model_facts *about = model_about(model);
    metrics *self = xcalloc(1, sizeof *self);
    *self = (metrics){.model = model,
                      .window = *window,
                      .position = -INFINITY,
                      .closed = event_kind("contact_closed"),
                      .impact = event_kind("impact")};
    memory_arena *arena = &self->arena;
    self->start = dae_state_create(&about->dae, arena);
    self->settled.is_settled = NAN;
    self->y = arena_calloc(arena, (size_t)about->dae.n, sizeof *self->y);
    self->values = arena_calloc(arena, (size_t)about->n_values, sizeof *self->values);
    metric_sums_init(&self->sums, model, taken, arena);
    const int angle = (int)(model_output_named(model, "angle") - about->outputs);
    self->angles = model_sampler_create(model, 1, &angle);
    return self;
}

void metrics_delete(metrics **pointer)
{
    metrics *self = *pointer;
    *pointer = NULL;
    if (self != NULL) {
        metric_sums_clear(&self->sums);
        model_sampler_delete(&self->angles);
        arena_free(&self->arena);
        free(self);
    }
}

void metrics_serialize(metrics *self, archive *archive)
{
    metric_sums_serialize(&self->sums, archive);
    SERIALIZE(archive, self->is_set_up);
    SERIALIZE(archive, self->has_started);
    SERIALIZE(archive, self->sense);
    SERIALIZE(archive, self->start_position);
    SERIALIZE(archive, self->first);
    SERIALIZE(archive, self->next);
    SERIALIZE(archive, self->t_first);
    SERIALIZE(archive, self->t_last);
    SERIALIZE(archive, self->position);
    SERIALIZE(archive, self->first_seen);
    SERIALIZE(archive, self->periods);
    SERIALIZE(archive, self->has_start);
    SERIALIZE(archive, self->starts_periodic);
    const dae *dae = &model_about(self->model)->dae;
    SERIALIZE(archive, self->start.t);
    SERIALIZE_ARRAY(archive, self->start.y, dae->n);
    SERIALIZE_ARRAY(archive, self->start.integers, dae->n_integers);
    SERIALIZE_ARRAY(archive, self->start.reals, dae->n_reals);
}

/* ---- positions ---- */

/** Set the constants, from any state. */
static bool set_up(metrics *self, const integrate_step *step)
{
    char message[DAE_MESSAGE_LENGTH];
    dae_state state = *step->state;
    state.t = step->t_to;
    state.y = self->y;
    if (!step->interpolate(step->with, step->t_to, self->y) ||
        model_outputs(self->model, &state, self->values, message) != DAE_OK) {
        return false;
    }
    metric_sums_begin(&self->sums, self->values, self->window.mesh);
    const int wheel = self->window.wheel;
    const mesh_metrics *mesh = &self->sums.meshes[self->window.mesh];
    self->sense =
        wheel < 0
            ? mesh->per_turn
            : (model_output_value(self->model, self->values, "angular_velocity", wheel) < 0 ? -1 / two_pi : 1 / two_pi);
    self->start_position = mesh->xi_0;
    if (wheel >= 0) { /* a steady start is inside a pitch: revolutions are counted from the start of the wheel */
        if (!self->has_start || model_outputs(self->model, &self->start, self->values, message) != DAE_OK) {
            return false;
        }
        self->start_position = -self->sense * model_output_value(self->model, self->values, "angle", wheel);
    }
    self->is_set_up = true;
    return true;
}

/** Position of the window's mesh or wheel. @return NAN if not available */
static double position_at(metrics *self, const integrate_step *step, double t)
{
    char message[DAE_MESSAGE_LENGTH];
    const int wheel = self->window.wheel < 0 ? self->sums.meshes[self->window.mesh].wheel : self->window.wheel;
    if (!step->interpolate(step->with, t, self->y) ||
        model_sampler_ask(self->angles, 1, &t, self->y, step->state, self->values, message) != DAE_OK) {
        return NAN;
    }
    return self->start_position + self->sense * self->values[wheel];
}

typedef struct {
    metrics *self;
    const integrate_step *step;
    double target;
} aim;

static double past(void *of, double t)
{
    const aim *aim = of;
    return position_at(aim->self, aim->step, t) - aim->target;
}

/** Time at which a position between two bracketing times is reached. */
static double time_of(metrics *self, const integrate_step *step, double target, double t_a, double f_a, double t_b,
                      double f_b)
{
    static const double near = 1e-13; /* periods */
    return secant_zero(past, &(aim){self, step, target}, t_a, f_a, t_b, f_b, near);
}

/* ---- parts of steps ---- */

/** Add a part of a step that is short enough for the nodes. */
static void add_part(metrics *self, const integrate_step *step, double from, double to)
{
    if (step_nodes_look(&self->sums.nodes, step, from, to)) {
        metric_sums_add(&self->sums, step, from, to);
    }
}

static void add_span(metrics *self, const integrate_step *step, double from, double to, double pitches)
{
    const double waves = METRIC_HARMONICS * fabs(pitches);
    const int parts = 1 + (int)fmin(waves / step_nodes_reach(&self->sums.nodes), 1e6);
    for (int i = 0; i < parts && to > from; i++) {
        add_part(self, step, from + (to - from) * i / parts,
                 i == parts - 1 ? to : from + (to - from) * (i + 1) / parts);
    }
}

static void complete_period(metrics *self, double t)
{
    metric_sums_complete(&self->sums);
    self->periods++;
    self->t_last = t;
}

/* ---- whole steps ---- */

/** Start of a period: the window starts, or a period is complete. */
static void pass_border(metrics *self, double t)
{
    if (self->has_started) {
        complete_period(self, t);
    } else {
        self->has_started = true;
        self->first = self->next;
        self->t_first = self->t_last = t;
    }
    self->next += 1;
}

static double pitches_of(const metrics *self, double from, double to)
{
    /* a revolution has about as many pitches as the driving wheel of the first mesh has teeth */
    return self->window.wheel < 0 ? to - from
                                  : (to - from) * fabs(self->sums.meshes[self->window.mesh].per_turn) * two_pi;
}

/** Usual case: the whole step lies in one period, far from its end, and is short enough for the nodes. @return whether
 *  this applied */
static bool add_plain(metrics *self, const integrate_step *step, double from, double to)
{
    static const double margin = 0.01, rounding = 1e-9;
    const int wheel = self->window.wheel < 0 ? self->sums.meshes[self->window.mesh].wheel : self->window.wheel;
    double position[STEP_NODES_MOST] = {0};
    if (!step_nodes_look(&self->sums.nodes, step, from, to)) {
        return false;
    }
    const double *angle = step_nodes_value(&self->sums.nodes, self->sums.indices.at[AT_ANGLE] + wheel);
    for (int k = 0; k < self->sums.nodes.n; k++) {
        position[k] = self->start_position + self->sense * angle[k];
    }
    const double end = step_nodes_end(&self->sums.nodes, position), distance = 2 * fabs(end - position[0]);
    if (METRIC_HARMONICS * pitches_of(self, 0, distance) > step_nodes_reach(&self->sums.nodes) ||
        !(end + margin * distance + rounding < self->next)) {
        return false;
    }
    metric_sums_add(&self->sums, step, from, to);
    self->position = end > self->position ? end : self->position;
    return true;
}

void metrics_monitor(metrics *self, const integrate_step *step)
{
    static const double rounding = 1e-10; /* [periods] a start this close to the start of a period is on it */
    double t = fmax(step->t_from, self->window.from);
    const double t_end = fmin(step->t_to, self->window.to);
    if (!(t_end > t) || (!self->is_set_up && !set_up(self, step))) {
        return;
    }
    if (self->has_started && add_plain(self, step, t, t_end)) {
        return;
    }
    double here = position_at(self, step, t);
    const double end = position_at(self, step, t_end);
    if (isnan(here) || isnan(end)) {
        return;
    }
    if (!(self->position > -INFINITY)) {
        self->first_seen = self->position = here;
        self->next = self->window.begins + ceil(here - self->window.begins - rounding);
        if (self->next <= here) {
            pass_border(self, t);
        }
    }
    while (end >= self->next) {
        const double t_border =
            here >= self->next ? t : time_of(self, step, self->next, t, here - self->next, t_end, end - self->next);
        if (self->has_started) {
            add_span(self, step, t, t_border, pitches_of(self, here, self->next));
        }
        here = self->next;
        t = t_border;
        pass_border(self, t);
    }
    if (self->has_started) {
        add_span(self, step, t, t_end, pitches_of(self, here, end));
    }
    self->position = fmax(self->position, end);
}

void metrics_event(metrics *self, const event_record *record)
{
    char message[DAE_MESSAGE_LENGTH];
    const int m = record->what.subject, kind = record->what.kind;
    if (!self->has_started || m < 0 || m >= self->sums.n_meshes || (kind != self->closed && kind != self->impact) ||
        record->t > self->window.to || model_outputs(self->model, record->before, self->values, message) != DAE_OK ||
        model_output_value(self->model, self->values, "pairs_in_contact", m) > 0) {
        return;
    }
    mesh_metrics_impact(&self->sums.meshes[m], record->t,
                        fabs(model_output_value(self->model, self->values, "gap_rate", m)));
}

/* ---- results ---- */

void metrics_start(metrics *self, const dae_state *start, bool is_periodic)
{
    if (self->has_start) { /* a resumed run has its original start */
        return;
    }
    dae_state_copy(&model_about(self->model)->dae, &self->start, start);
    self->has_start = true;
    self->starts_periodic = is_periodic;
}

void metrics_judge(metrics *self)
{
    if (self->periods > 0 && self->has_start) {
        settled_judge(&self->sums, &self->start, self->starts_periodic, self->t_first, self->t_last, &self->settled);
    }
}

const settled_result *metrics_settled(const metrics *self)
{
    return &self->settled;
}

metric_span metrics_span(const metrics *self)
{
    return (metric_span){self->periods > 0 ? self->t_first : NAN, self->periods > 0 ? self->t_last : NAN, self->periods,
                         self->position > -INFINITY ? self->position - self->first_seen : 0};
}

void metrics_conclude(const metrics *self, double *values)
{
    model_output rows[N_METRIC_ROWS];
    const int n = metric_rows_lay_out(&model_about(self->model)->names, rows);
    for (int i = 0; i < n; i++) {
        values[i] = NAN;
    }
    if (self->periods > 0) {
        metric_sums_conclude(&self->sums, rows, values);
    }
}

void metrics_explain(const metrics *self, char *text, size_t size)
{
    text[0] = '\0';
    if (self->periods > 0) {
        return;
    }
    const model_names *names = &model_about(self->model)->names;
    const bool by_mesh = self->window.wheel < 0;
    const double distance = metrics_span(self).begun;
    if (by_mesh) {
        (void)snprintf(text, size,
                       "the window of the metrics contains no whole pitch of mesh '%s', from one start of contact to "
                       "the next: only %.3g pitches; start the window earlier, or increase the duration",
                       names->meshes.names[self->window.mesh], distance);
    } else {
        (void)snprintf(text, size,
                       "the window of the metrics contains no whole revolution of wheel '%s', counted from its start: "
                       "only %.3g revolutions; start the window earlier, or increase the duration",
                       names->wheels.names[self->window.wheel], distance);
    }
}
