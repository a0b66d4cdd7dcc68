#include "simulate/number_sums.h"

#include "base/words.h"

#include <math.h>
#include <string.h>

static const double two_pi = 6.283185307179586;

struct sums_channel {
    int quantity, element;
    int value; /**< index at the nodes */
    int mesh;  /**< whose pitch defines its harmonics */
    number_channel sums;
};

/** Create a channel for each element of the quantities that the rows evaluate. */
static void open_channels(number_sums *sums, memory_pool *pool)
{
    const model_names *names = &model_about(sums->model)->names;
    int counts[N_NUMBER_QUANTITIES] = {0}, n = 0;
    for (int i = 0; i < N_NUMBER_ROWS; i++) {
        const int quantity = number_rows[i].quantity;
        if (sums->taken[i] && quantity != QUANTITY_none && counts[quantity] == 0) {
            n += counts[quantity] = number_count(number_quantities[quantity].dims, names);
        }
    }
    if (n == 0) { /* the check for settled motion needs a quantity */
        n = counts[QUANTITY_transmission_error] = names->meshes.n;
    }
    sums->channels = pool_calloc(pool, (size_t)n, sizeof *sums->channels);
    for (int quantity = 0; quantity < N_NUMBER_QUANTITIES; quantity++) {
        const char *name = number_quantities[quantity].name;
        const int value = counts[quantity] > 0 ? step_nodes_want(&sums->nodes, name) : -1;
        sums->first[quantity] = value < 0 ? -1 : sums->n_channels;
        for (int i = 0; i < counts[quantity] && value >= 0; i++) {
            sums_channel *one = &sums->channels[sums->n_channels++];
            *one = (sums_channel){.quantity = quantity, .element = i, .value = value + i};
            number_channel_init(&one->sums);
        }
    }
}

void number_sums_init(number_sums *self, const model *model, const bool *taken, memory_pool *pool)
{
    const model_names *names = &model_about(model)->names;
    *self = (number_sums){.model = model, .n_meshes = names->meshes.n, .n_pairs = names->pairs.n};
    bool *own = pool_calloc(pool, N_NUMBER_ROWS, sizeof *own);
    self->taken = memcpy(own, taken, N_NUMBER_ROWS * sizeof *own);
    self->meshes = pool_calloc(pool, (size_t)self->n_meshes, sizeof *self->meshes);
    self->waves = pool_calloc(pool, (size_t)self->n_meshes, sizeof *self->waves);
    for (int m = 0; m < self->n_meshes; m++) {
        number_waves_init(&self->waves[m]);
    }
    unsigned needs = NEEDS_NOTHING;
    for (int i = 0; i < N_NUMBER_ROWS; i++) {
        needs |= own[i] ? number_rows[i].outputs : NEEDS_NOTHING;
    }
    step_nodes_init(&self->nodes, model, pool);
    mesh_numbers_want(needs, &self->nodes, &self->places);
    open_channels(self, pool);
    number_blocks_init(&self->blocks, self->n_channels, pool);
}

void number_sums_clear(number_sums *self)
{
    step_nodes_clear(&self->nodes);
}

void number_sums_keep(number_sums *self, archive *archive)
{
    KEEP_ARRAY(archive, self->meshes, self->n_meshes);
    for (int i = 0; i < self->n_channels; i++) {
        sums_channel *one = &self->channels[i];
        KEEP(archive, one->mesh);
        KEEP(archive, one->sums);
    }
    KEEP_ARRAY(archive, self->waves, self->n_meshes);
    number_blocks_keep(&self->blocks, archive);
}

/** The mesh whose pitch defines the harmonics of a wheel: that of the window, `preferred`, if it belongs to the wheel,
 *  else the wheel's first. */
static int mesh_of_wheel(const number_sums *self, const double *values, int wheel, int preferred)
{
    int found = -1;
    for (int m = self->n_meshes - 1; m >= 0; m--) {
        const bool is_its =
            self->meshes[m].wheel == wheel || (int)model_output_value(self->model, values, "driven_wheel", m) == wheel;
        found = is_its && (found < 0 || found != preferred) ? m : found;
    }
    return found < 0 ? preferred : found;
}

void number_sums_begin(number_sums *self, const double *values, int preferred)
{
    for (int m = 0; m < self->n_meshes; m++) {
        mesh_numbers *mesh = &self->meshes[m];
        mesh->wheel = (int)model_output_value(self->model, values, "driving_wheel", m);
        mesh->xi_0 = model_output_value(self->model, values, "start_position", m);
        mesh->per_turn = -model_output_value(self->model, values, "flank", m) *
                         model_output_value(self->model, values, "teeth", mesh->wheel) / two_pi;
        mesh->mass = model_output_value(self->model, values, "reference_mass", m);
    }
    const model_names *names = &model_about(self->model)->names;
    for (int i = 0; i < self->n_channels; i++) {
        sums_channel *one = &self->channels[i];
        const char *dims = number_quantities[one->quantity].dims;
        const name_list *of = number_elements(dims, names);
        const int each = number_count(dims, names) / of->n;
        one->mesh = of == &names->meshes   ? one->element
                    : of == &names->wheels ? mesh_of_wheel(self, values, one->element / each, preferred)
                                           : preferred;
    }
}

void number_sums_add(number_sums *self)
{
    for (int m = 0; m < self->n_meshes; m++) {
        mesh_numbers_add(&self->meshes[m], m, self->n_pairs, &self->places, &self->nodes, &self->waves[m]);
    }
    for (int i = 0; i < self->n_channels; i++) {
        sums_channel *one = &self->channels[i];
        number_channel_add(&one->sums, &self->nodes, &self->waves[one->mesh],
                           step_nodes_value(&self->nodes, one->value));
    }
}

void number_sums_complete(number_sums *self)
{
    number_blocks_period(&self->blocks, self->meshes[0].period.time);
    for (int m = 0; m < self->n_meshes; m++) {
        mesh_numbers_complete(&self->meshes[m]);
    }
    for (int i = 0; i < self->n_channels; i++) {
        number_blocks_add(&self->blocks, i, number_channel_complete(&self->channels[i].sums));
    }
}

static channel_window conclude_channel(const number_sums *self, const sums_channel *one)
{
    const mesh_sums *mesh = &self->meshes[one->mesh].total;
    return number_channel_conclude(&one->sums, mesh->time, mesh->pitches, number_quantities[one->quantity].least);
}

void number_sums_followed(const number_sums *self, int channel, number_followed *followed)
{
    const sums_channel *one = &self->channels[channel];
    *followed =
        (number_followed){.quantity = one->quantity, .element = one->element, .window = conclude_channel(self, one)};
    followed->has_halves = number_blocks_halves(&self->blocks, channel, &followed->halves);
    followed->halves.first += one->sums.shift;
    followed->halves.second += one->sums.shift;
}

/** @param windows  of all channels; values [those of the row] */
static void conclude_row(const number_sums *self, const number_row *row, int n_values, const channel_window *windows,
                         double *values)
{
    const int each = words_contain(row->dims, "harmonic") ? NUMBER_HARMONICS : 1;
    const bool has_quantity = row->quantity != QUANTITY_none;
    const int first = has_quantity ? self->first[row->quantity] : -1;
    if ((has_quantity && first < 0) || !mesh_numbers_have(&self->places, row->outputs)) {
        return;
    }
    for (int i = 0; i < n_values; i++) {
        const int channel = first + i / each, m = has_quantity ? self->channels[channel].mesh : i;
        const number_source source = {has_quantity ? &windows[channel] : NULL, &self->meshes[m], m, self->model};
        values[i] = row->formula(&source, i % each);
    }
}

void number_sums_conclude(const number_sums *self, const model_output *rows, double *values)
{
    OWNED channel_window *windows = xcalloc((size_t)self->n_channels, sizeof *windows);
    for (int i = 0; i < self->n_channels; i++) {
        windows[i] = conclude_channel(self, &self->channels[i]);
    }
    for (int i = 0; i < N_NUMBER_ROWS; i++) {
        if (self->taken[i]) {
            conclude_row(self, &number_rows[i], rows[i].count, windows, values + rows[i].offset);
        }
    }
}
