#include "simulate/numbers.h"

#include "base/memory.h"
#include "base/secant.h"
#include "base/words.h"
#include "simulate/mesh_numbers.h"
#include "simulate/number_channel.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double two_pi = 6.283185307179586;

/* ---- what is kept ---- */

/** A channel is one element of an output. */
typedef struct {
    int row;     /**< first of its rows: those of its quantity */
    int element; /**< of the quantity */
    int value;   /**< index at the nodes */
    int mesh;    /**< whose pitches its harmonics are of */
    number_channel sums;
} channel;

struct numbers {
    memory_pool pool;
    const model *model;
    number_window window;
    const bool *taken;
    int n_meshes, n_channels, n_pairs;
    mesh_numbers *meshes;
    channel *channels;
    number_waves *waves; /**< [n_meshes] */
    step_nodes nodes;
    mesh_places places;
    model_sampler *angles;  /**< of all wheels, at one state */
    double *y, *values;     /**< of one state */
    int closed, impact;     /**< event kinds */
    bool is_set_up;         /**< constants are known */
    bool has_started;       /**< the window has begun */
    double sense;           /**< of the window's wheel, pitches or turns a radian */
    double start_position;  /**< where its angle is 0 */
    double first, next;     /**< position where the window began; of the end of the present period */
    double t_first, t_last; /**< of the complete periods */
    double position;        /**< furthest that was reached */
    double first_seen;      /**< first position in the window */
    long periods;
};

static bool takes(const numbers *numbers, int first, int n)
{
    bool any = false;
    for (int i = 0; i < n; i++) {
        any = any || numbers->taken[first + i];
    }
    return any;
}

/** Whether a quantity has to be followed: the dynamic factor is made of the force. */
static bool follows(const numbers *numbers, int quantity)
{
    return takes(numbers, number_row(quantity, (number_tells)0), N_TELLS) ||
           (quantity == NUMBER_FORCE && numbers->taken[number_row_of_contact(NUMBER_DYNAMIC)]);
}

static void open_channels(numbers *numbers)
{
    for (int quantity = 0; quantity < N_NUMBER_QUANTITIES; quantity++) {
        const char *name = number_quantity(quantity);
        const int value = follows(numbers, quantity) ? step_nodes_want(&numbers->nodes, name) : -1;
        const int count = value < 0 ? 0 : model_output_named(numbers->model, name)->count;
        for (int i = 0; i < count; i++) {
            channel *one = &numbers->channels[numbers->n_channels++];
            *one = (channel){.row = number_row(quantity, (number_tells)0), .element = i, .value = value + i};
            number_channel_init(&one->sums);
        }
    }
}

static int event_kind(const char *name)
{
    return words_index(name, model_tables()->n_event_kinds, model_tables()->event_kinds);
}

numbers *numbers_create(const model *model, const number_window *window, const bool *taken)
{
    const model_facts *about = model_about(model);
    numbers *self = xcalloc(1, sizeof *self);
    *self = (numbers){.model = model,
                      .window = *window,
                      .n_meshes = about->names.meshes.n,
                      .n_pairs = about->names.pairs.n,
                      .position = -INFINITY,
                      .closed = event_kind("contact_closed"),
                      .impact = event_kind("impact")};
    memory_pool *pool = &self->pool;
    bool *own = pool_calloc(pool, N_NUMBER_ROWS, sizeof *own);
    self->taken = memcpy(own, taken, N_NUMBER_ROWS * sizeof *own);
    self->meshes = pool_calloc(pool, (size_t)self->n_meshes, sizeof *self->meshes);
    self->waves = pool_calloc(pool, (size_t)self->n_meshes, sizeof *self->waves);
    for (int m = 0; m < self->n_meshes; m++) {
        number_waves_init(&self->waves[m]);
    }
    self->channels = pool_calloc(
        pool, 2 * (size_t)self->n_meshes + 3 * (size_t)about->names.wheels.n + (size_t)about->names.accelerometers.n,
        sizeof *self->channels);
    self->y = pool_calloc(pool, (size_t)about->dae.n, sizeof *self->y);
    self->values = pool_calloc(pool, (size_t)about->n_values, sizeof *self->values);
    step_nodes_init(&self->nodes, model, pool);
    mesh_numbers_want(own, &self->nodes, &self->places);
    const int angle = (int)(model_output_named(model, mesh_output(AT_ANGLE)) - about->outputs);
    self->angles = model_sampler_create(model, 1, &angle);
    open_channels(self);
    return self;
}

void numbers_delete(numbers **pointer)
{
    numbers *self = *pointer;
    *pointer = NULL;
    if (self != NULL) {
        step_nodes_clear(&self->nodes);
        model_sampler_delete(&self->angles);
        pool_free(&self->pool);
        free(self);
    }
}

void numbers_keep(numbers *self, archive *archive)
{
    KEEP_ARRAY(archive, self->meshes, self->n_meshes);
    for (int i = 0; i < self->n_channels; i++) {
        channel *one = &self->channels[i];
        KEEP(archive, one->mesh);
        KEEP(archive, one->sums);
    }
    KEEP_ARRAY(archive, self->waves, self->n_meshes);
    KEEP(archive, self->is_set_up);
    KEEP(archive, self->has_started);
    KEEP(archive, self->sense);
    KEEP(archive, self->start_position);
    KEEP(archive, self->first);
    KEEP(archive, self->next);
    KEEP(archive, self->t_first);
    KEEP(archive, self->t_last);
    KEEP(archive, self->position);
    KEEP(archive, self->first_seen);
    KEEP(archive, self->periods);
}

/* ---- positions ---- */

static double constant(const numbers *self, const char *name, int index)
{
    const int offset = model_output_offset(self->model, name);
    return offset < 0 ? NAN : self->values[offset + index];
}

/** The mesh whose pitches the harmonics of a wheel are of: the window's if it is one of its, else its first. */
static int mesh_of_wheel(const numbers *self, int wheel)
{
    int found = -1;
    for (int m = self->n_meshes - 1; m >= 0; m--) {
        const bool is_its = self->meshes[m].wheel == wheel || (int)constant(self, "driven_wheel", m) == wheel;
        found = is_its && (found < 0 || found != self->window.mesh) ? m : found;
    }
    return found < 0 ? self->window.mesh : found;
}

/** What never changes, from any state. */
static bool set_up(numbers *self, const integrate_step *step)
{
    char message[DAE_MESSAGE_LENGTH];
    dae_state state = *step->state;
    state.t = step->t_to;
    state.y = self->y;
    if (!step->interpolate(step->with, step->t_to, self->y) ||
        model_outputs(self->model, &state, self->values, message) != DAE_OK) {
        return false;
    }
    for (int m = 0; m < self->n_meshes; m++) {
        mesh_numbers *mesh = &self->meshes[m];
        mesh->wheel = (int)constant(self, "driving_wheel", m);
        mesh->xi_0 = constant(self, "start_position", m);
        mesh->per_turn = -constant(self, "flank", m) * constant(self, "teeth", mesh->wheel) / two_pi;
        mesh->mass = constant(self, "reference_mass", m);
    }
    for (int i = 0; i < self->n_channels; i++) {
        channel *one = &self->channels[i];
        const int quantity = one->row / N_TELLS;
        const int wheel = quantity == NUMBER_AXLE ? one->element / 2 : one->element;
        one->mesh = quantity == NUMBER_ACCELEROMETER                     ? self->window.mesh
                    : quantity == NUMBER_SPIN || quantity == NUMBER_AXLE ? mesh_of_wheel(self, wheel)
                                                                         : one->element;
    }
    const int wheel = self->window.wheel;
    const mesh_numbers *mesh = &self->meshes[self->window.mesh];
    self->sense =
        wheel < 0 ? mesh->per_turn : (constant(self, "angular_velocity", wheel) < 0 ? -1 / two_pi : 1 / two_pi);
    self->start_position = wheel < 0 ? mesh->xi_0 : 0;
    self->is_set_up = true;
    return true;
}

/** Position of the window's mesh or wheel. @return NAN if it is not known */
static double position_at(numbers *self, const integrate_step *step, double t)
{
    char message[DAE_MESSAGE_LENGTH];
    const int wheel = self->window.wheel < 0 ? self->meshes[self->window.mesh].wheel : self->window.wheel;
    if (!step->interpolate(step->with, t, self->y) ||
        model_sampler_ask(self->angles, 1, &t, self->y, step->state, self->values, message) != DAE_OK) {
        return NAN;
    }
    return self->start_position + self->sense * self->values[wheel];
}

typedef struct {
    numbers *self;
    const integrate_step *step;
    double target;
} aim;

static double past(void *of, double t)
{
    const aim *aim = of;
    return position_at(aim->self, aim->step, t) - aim->target;
}

/** When a position is reached between two times around it. */
static double time_of(numbers *self, const integrate_step *step, double target, double t_a, double f_a, double t_b,
                      double f_b)
{
    static const double near = 1e-13; /* periods */
    return secant_zero(past, &(aim){self, step, target}, t_a, f_a, t_b, f_b, near);
}

/* ---- sums ---- */

/** What is known at the nodes. */
static void add_nodes(numbers *self)
{
    for (int m = 0; m < self->n_meshes; m++) {
        mesh_numbers_add(&self->meshes[m], m, self->n_pairs, &self->places, &self->nodes, &self->waves[m]);
    }
    for (int i = 0; i < self->n_channels; i++) {
        channel *one = &self->channels[i];
        number_channel_add(&one->sums, &self->nodes, &self->waves[one->mesh],
                           step_nodes_value(&self->nodes, one->value));
    }
}

/** A part of a step in which less than the reach of the nodes passes. */
static void add_part(numbers *self, const integrate_step *step, double from, double to)
{
    if (step_nodes_look(&self->nodes, step, from, to)) {
        add_nodes(self);
    }
}

static void add_span(numbers *self, const integrate_step *step, double from, double to, double pitches)
{
    const double waves = NUMBER_HARMONICS * fabs(pitches);
    const int parts = 1 + (int)fmin(waves / step_nodes_reach(&self->nodes), 1e6);
    for (int i = 0; i < parts && to > from; i++) {
        add_part(self, step, from + (to - from) * i / parts,
                 i == parts - 1 ? to : from + (to - from) * (i + 1) / parts);
    }
}

static void complete_period(numbers *self, double t)
{
    for (int m = 0; m < self->n_meshes; m++) {
        mesh_numbers_complete(&self->meshes[m]);
    }
    for (int i = 0; i < self->n_channels; i++) {
        number_channel_complete(&self->channels[i].sums);
    }
    self->periods++;
    self->t_last = t;
}

/* ---- the steps ---- */

/** A beginning of a period: the window starts, or one is complete. */
static void pass_border(numbers *self, double t)
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

static double pitches_of(const numbers *self, double from, double to)
{
    /* a turn has as many pitches as the wheel that drives the first mesh has teeth, or about so many */
    return self->window.wheel < 0 ? to - from : (to - from) * fabs(self->meshes[self->window.mesh].per_turn) * two_pi;
}

/** Most steps: all of it lies in one period, far from its end, and within the reach of the nodes. @return whether it was that */
static bool add_plain(numbers *self, const integrate_step *step, double from, double to)
{
    static const double margin = 0.01, rounding = 1e-9;
    const int wheel = self->window.wheel < 0 ? self->meshes[self->window.mesh].wheel : self->window.wheel;
    double position[STEP_NODES_MOST] = {0};
    if (!step_nodes_look(&self->nodes, step, from, to)) {
        return false;
    }
    const double *angle = step_nodes_value(&self->nodes, self->places.at[AT_ANGLE] + wheel);
    for (int k = 0; k < self->nodes.n; k++) {
        position[k] = self->start_position + self->sense * angle[k];
    }
    const double end = step_nodes_end(&self->nodes, position), way = 2 * fabs(end - position[0]);
    if (NUMBER_HARMONICS * pitches_of(self, 0, way) > step_nodes_reach(&self->nodes) ||
        !(end + margin * way + rounding < self->next)) {
        return false;
    }
    add_nodes(self);
    self->position = end > self->position ? end : self->position;
    return true;
}

void numbers_watch(numbers *self, const integrate_step *step)
{
    static const double rounding = 1e-10; /* periods: a start as near to a border as that is on it */
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

void numbers_event(numbers *self, const event_record *record)
{
    char message[DAE_MESSAGE_LENGTH];
    const int m = record->what.subject, kind = record->what.kind;
    if (!self->has_started || m < 0 || m >= self->n_meshes || (kind != self->closed && kind != self->impact) ||
        record->t > self->window.to || model_outputs(self->model, record->before, self->values, message) != DAE_OK ||
        constant(self, "pairs_in_contact", m) > 0) {
        return;
    }
    mesh_numbers_impact(&self->meshes[m], record->t, fabs(constant(self, "gap_rate", m)));
}

/* ---- results ---- */

number_span numbers_span(const numbers *self)
{
    return (number_span){self->periods > 0 ? self->t_first : NAN, self->periods > 0 ? self->t_last : NAN, self->periods,
                         self->position > -INFINITY ? self->position - self->first_seen : 0};
}

static void conclude_channel(const numbers *self, const channel *one, const int *offsets, double *values)
{
    channel_numbers told = {0};
    const mesh_sums *mesh = &self->meshes[one->mesh].total;
    const bool is_force = one->row == number_row(NUMBER_FORCE, (number_tells)0);
    number_channel_conclude(&one->sums, mesh->time, mesh->pitches, &told);
    told.low =
        is_force ? fmax(told.low, 0) : told.low; /* flanks only push; the rest is rounding at the ends of steps */
    const double numbers[] = {[TELLS_MEAN] = told.mean,   [TELLS_DEVIATION] = told.deviation,
                              [TELLS_RMS] = told.rms,     [TELLS_RANGE] = told.high - told.low,
                              [TELLS_HIGH] = told.high,   [TELLS_LOW] = told.low,
                              [TELLS_CREST] = told.crest, [TELLS_KURTOSIS] = told.kurtosis};
    for (int i = 0; i < TELLS_AMPLITUDE; i++) {
        values[offsets[one->row + i] + one->element] = numbers[i];
    }
    for (int n = 0; n < NUMBER_HARMONICS; n++) {
        const int place = one->element * NUMBER_HARMONICS + n;
        values[offsets[one->row + TELLS_AMPLITUDE] + place] = told.amplitude[n];
        values[offsets[one->row + TELLS_PHASE] + place] = told.phase[n];
    }
    if (is_force) {
        values[offsets[number_row_of_contact(NUMBER_DYNAMIC)] + one->element] = told.high / told.mean;
    }
}

void numbers_conclude(const numbers *self, double *values)
{
    int offsets[N_NUMBER_ROWS];
    const int n = number_rows_offsets(&model_about(self->model)->names, offsets);
    for (int i = 0; i < n; i++) {
        values[i] = NAN;
    }
    if (self->periods == 0) {
        return;
    }
    for (int i = 0; i < self->n_channels; i++) {
        conclude_channel(self, &self->channels[i], offsets, values);
    }
    for (int m = 0; m < self->n_meshes; m++) {
        mesh_numbers_conclude(&self->meshes[m], m, &self->places, self->model, self->taken, offsets, values);
    }
}

void numbers_explain(const numbers *self, char *text, size_t size)
{
    text[0] = '\0';
    if (self->periods > 0) {
        return;
    }
    const model_names *names = &model_about(self->model)->names;
    const bool by_mesh = self->window.wheel < 0;
    const double way = numbers_span(self).begun;
    if (by_mesh) {
        (void)snprintf(
            text, size,
            "the window of the numbers holds no whole pitch of mesh '%s', from one start of contact to the next: it "
            "went %.3g pitches in it; begin earlier, or run longer",
            names->meshes.names[self->window.mesh], way);
    } else {
        (void)snprintf(
            text, size,
            "the window of the numbers holds no whole turn of wheel '%s', counted from its start: it went %.3g "
            "turns in it; begin earlier, or run longer",
            names->wheels.names[self->window.wheel], way);
    }
}
