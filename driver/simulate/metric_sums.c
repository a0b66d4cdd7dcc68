#include "simulate/metric_sums.h"

#include "base/words.h"

#include <math.h>
#include <string.h>

static const double two_pi = 6.283185307179586;

struct sums_channel {
    int quantity, element;
    int value; /**< index at the nodes */
    int mesh;  /**< whose pitch defines its harmonics */
    metric_channel sums;
};

/** Create a channel for each element of the quantities that the rows evaluate. */
static void open_channels(metric_sums *sums, memory_arena *arena)
{
    const model_names *names = &model_about(sums->model)->names;
    int counts[N_METRIC_QUANTITIES] = {0}, n = 0;
    for (int i = 0; i < N_METRIC_ROWS; i++) {
        const int quantity = metric_rows[i].quantity;
        if (sums->taken[i] && quantity != QUANTITY_none && counts[quantity] == 0) {
            n += counts[quantity] = metric_count(metric_quantities[quantity].dims, names);
        }
    }
    if (n == 0) { /* the check for settled motion needs a quantity */
        n = counts[QUANTITY_transmission_error] = names->meshes.n;
    }
    sums->channels = arena_calloc(arena, (size_t)n, sizeof *sums->channels);
    for (int quantity = 0; quantity < N_METRIC_QUANTITIES; quantity++) {
        const char *name = metric_quantities[quantity].name;
        const int value = counts[quantity] > 0 ? step_nodes_want(&sums->nodes, name) : -1;
        sums->first[quantity] = value < 0 ? -1 : sums->n_channels;
        for (int i = 0; i < counts[quantity] && value >= 0; i++) {
            sums_channel *one = &sums->channels[sums->n_channels++];
            *one = (sums_channel){.quantity = quantity, .element = i, .value = value + i};
            metric_channel_init(&one->sums);
        }
    }
}

void metric_sums_init(metric_sums *self, const model *model, const bool *taken, memory_arena *arena)
{
    const model_names *names = &model_about(model)->names;
    *self = (metric_sums){.model = model, .n_meshes = names->meshes.n, .n_pairs = names->pairs.n};
    bool *own = arena_calloc(arena, N_METRIC_ROWS, sizeof *own);
    self->taken = memcpy(own, taken, N_METRIC_ROWS * sizeof *own);
    self->meshes = arena_calloc(arena, (size_t)self->n_meshes, sizeof *self->meshes);
    self->waves = arena_calloc(arena, (size_t)self->n_meshes, sizeof *self->waves);
    for (int m = 0; m < self->n_meshes; m++) {
        metric_waves_init(&self->waves[m]);
    }
    unsigned needs = NEEDS_NOTHING;
    bool seeks_roots = false, seeks_temperatures = false;
    for (int i = 0; i < N_METRIC_ROWS; i++) {
        const bool has = own[i] && metric_row_exists(model, i);
        needs |= has ? metric_rows[i].outputs : NEEDS_NOTHING;
        seeks_roots = seeks_roots || (has && metric_rows[i].request == METRIC_OF_ROOTS);
        seeks_temperatures = seeks_temperatures || (has && metric_rows[i].request == METRIC_OF_TEMPERATURES);
    }
    step_nodes_init(&self->nodes, model, arena);
    mesh_metrics_request(needs, &self->nodes, &self->indices);
    output_extremes_init(&self->roots, model, N_ROOT_EXTREMES, root_extremes_sought, seeks_roots, &self->nodes, arena);
    output_extremes_init(&self->temperatures, model, N_TEMPERATURE_EXTREMES, temperature_extremes_sought,
                         seeks_temperatures, &self->nodes, arena);
    root_ranges_init(&self->ranges, model, own[METRIC_root_stress_range], self->roots.n, arena);
    open_channels(self, arena);
    metric_blocks_init(&self->blocks, self->n_channels, arena);
}

void metric_sums_clear(metric_sums *self)
{
    step_nodes_clear(&self->nodes);
    output_extremes_clear(&self->roots);
    output_extremes_clear(&self->temperatures);
}

void metric_sums_serialize(metric_sums *self, archive *archive)
{
    SERIALIZE_ARRAY(archive, self->meshes, self->n_meshes);
    for (int i = 0; i < self->n_channels; i++) {
        sums_channel *one = &self->channels[i];
        SERIALIZE(archive, one->mesh);
        SERIALIZE(archive, one->sums);
    }
    SERIALIZE_ARRAY(archive, self->waves, self->n_meshes);
    metric_blocks_serialize(&self->blocks, archive);
    output_extremes_serialize(&self->roots, archive);
    output_extremes_serialize(&self->temperatures, archive);
    root_ranges_serialize(&self->ranges, archive);
}

/** The mesh whose pitch defines the harmonics of a wheel: that of the window, `preferred`, if it belongs to the wheel,
 *  else the wheel's first. */
static int mesh_of_wheel(const metric_sums *self, int wheel, int preferred)
{
    int found = -1;
    for (int m = self->n_meshes - 1; m >= 0; m--) {
        const bool is_its = self->meshes[m].wheel == wheel || self->meshes[m].driven == wheel;
        found = is_its && (found < 0 || found != preferred) ? m : found;
    }
    return found < 0 ? preferred : found;
}

void metric_sums_begin(metric_sums *self, const double *values, int preferred)
{
    for (int m = 0; m < self->n_meshes; m++) {
        mesh_metrics *mesh = &self->meshes[m];
        mesh->wheel = (int)model_output_value(self->model, values, "driving_wheel", m);
        mesh->driven = (int)model_output_value(self->model, values, "driven_wheel", m);
        mesh->xi_0 = model_output_value(self->model, values, "start_position", m);
        mesh->per_turn = -model_output_value(self->model, values, "flank", m) *
                         model_output_value(self->model, values, "teeth", mesh->wheel) / two_pi;
        mesh->mass = model_output_value(self->model, values, "reference_mass", m);
    }
    const model_names *names = &model_about(self->model)->names;
    for (int i = 0; i < self->n_channels; i++) {
        sums_channel *one = &self->channels[i];
        const char *dims = metric_quantities[one->quantity].dims;
        const name_list *of = metric_elements(dims, names);
        const int each = metric_count(dims, names) / of->n;
        one->mesh = of == &names->meshes   ? one->element
                    : of == &names->wheels ? mesh_of_wheel(self, one->element / each, preferred)
                                           : preferred;
    }
}

void metric_sums_add(metric_sums *self, const integrate_step *step, double from, double to)
{
    output_extremes_add(&self->roots, &self->nodes, step, from, to);
    output_extremes_add(&self->temperatures, &self->nodes, step, from, to);
    root_ranges_add(&self->ranges, &self->nodes);
    for (int m = 0; m < self->n_meshes; m++) {
        mesh_metrics_add(&self->meshes[m], m, self->n_pairs, &self->indices, &self->nodes, &self->waves[m]);
    }
    for (int i = 0; i < self->n_channels; i++) {
        sums_channel *one = &self->channels[i];
        metric_channel_add(&one->sums, &self->nodes, &self->waves[one->mesh],
                           step_nodes_value(&self->nodes, one->value));
    }
}

void metric_sums_complete(metric_sums *self)
{
    metric_blocks_period(&self->blocks, self->meshes[0].period.time);
    for (int m = 0; m < self->n_meshes; m++) {
        mesh_metrics_complete(&self->meshes[m]);
    }
    output_extremes_complete(&self->roots);
    output_extremes_complete(&self->temperatures);
    root_ranges_complete(&self->ranges);
    for (int i = 0; i < self->n_channels; i++) {
        metric_blocks_add(&self->blocks, i, metric_channel_complete(&self->channels[i].sums));
    }
}

static channel_window conclude_channel(const metric_sums *self, const sums_channel *one)
{
    const mesh_sums *mesh = &self->meshes[one->mesh].total;
    return metric_channel_conclude(&one->sums, mesh->time, mesh->pitches, metric_quantities[one->quantity].least);
}

void metric_sums_statistics(const metric_sums *self, int channel, metric_statistics *followed)
{
    const sums_channel *one = &self->channels[channel];
    *followed =
        (metric_statistics){.quantity = one->quantity, .element = one->element, .window = conclude_channel(self, one)};
    followed->has_halves = metric_blocks_halves(&self->blocks, channel, &followed->halves);
    followed->halves.first += one->sums.shift;
    followed->halves.second += one->sums.shift;
}

/** Root stress of the wheels. */
static void conclude_roots(const metric_sums *self, const metric_row *row, int n_values, double *values)
{
    for (int i = 0; i < n_values && i < self->roots.n; i++) {
        const metric_source source = {
            .mesh = self->meshes,
            .index = -1,
            .model = self->model,
            .wheel = i,
            .root = {output_extremes_of(&self->roots, ROOT_HIGH, i), output_extremes_of(&self->roots, ROOT_LOW, i)},
            .root_range = root_ranges_of(&self->ranges, i)};
        values[i] = isnan(source.root.high) ? NAN : row->formula(&source, 0);
    }
}

/** Largest value of all tooth pairs of a mesh; NaN if there is none. */
static double largest_of_pairs(const output_extremes *extremes, int output, int mesh, int n_pairs)
{
    double largest = NAN;
    for (int k = 0; k < n_pairs; k++) {
        largest = fmax(largest, output_extremes_of(extremes, output, mesh * n_pairs + k));
    }
    return largest;
}

/** Temperatures of the meshes. */
static void conclude_temperatures(const metric_sums *self, const metric_row *row, int n_values, double *values)
{
    const output_extremes *from = &self->temperatures;
    for (int i = 0; i < n_values && from->n > 0; i++) {
        const metric_source source = {.mesh = &self->meshes[i],
                                      .index = i,
                                      .model = self->model,
                                      .temperature = {largest_of_pairs(from, TEMPERATURE_FLASH, i, self->n_pairs),
                                                      largest_of_pairs(from, TEMPERATURE_CONTACT, i, self->n_pairs)}};
        values[i] = row->formula(&source, 0);
    }
}

/** @param windows  of all channels; values [those of the row] */
static void conclude_row(const metric_sums *self, const metric_row *row, int n_values, const channel_window *windows,
                         double *values)
{
    const int each = words_contain(row->dims, "harmonic") ? METRIC_HARMONICS : 1;
    const bool has_quantity = row->quantity != QUANTITY_none;
    const int first = has_quantity ? self->first[row->quantity] : -1;
    if ((has_quantity && first < 0) || !mesh_metrics_available(&self->indices, row->outputs)) {
        return;
    }
    for (int i = 0; i < n_values; i++) {
        const int channel = first + i / each, m = has_quantity ? self->channels[channel].mesh : i;
        const metric_source source = {.window = has_quantity ? &windows[channel] : NULL,
                                      .mesh = &self->meshes[m],
                                      .index = m,
                                      .model = self->model};
        values[i] = row->formula(&source, i % each);
    }
}

void metric_sums_conclude(const metric_sums *self, const model_output *rows, double *values)
{
    CLEANUP_FREE channel_window *windows = xcalloc((size_t)self->n_channels, sizeof *windows);
    for (int i = 0; i < self->n_channels; i++) {
        windows[i] = conclude_channel(self, &self->channels[i]);
    }
    for (int i = 0; i < N_METRIC_ROWS; i++) {
        if (self->taken[i] && metric_rows[i].request == METRIC_OF_ROOTS) {
            conclude_roots(self, &metric_rows[i], rows[i].count, values + rows[i].offset);
        } else if (self->taken[i] && metric_rows[i].request == METRIC_OF_TEMPERATURES) {
            conclude_temperatures(self, &metric_rows[i], rows[i].count, values + rows[i].offset);
        } else if (self->taken[i]) {
            conclude_row(self, &metric_rows[i], rows[i].count, windows, values + rows[i].offset);
        }
    }
}
