#include "simulate/number_sums.h"

#include <math.h>
#include <string.h>

static const double two_pi = 6.283185307179586;

struct sums_channel {
    int row;     /**< first of its rows: those of its quantity */
    int element; /**< of the quantity */
    int value;   /**< index at the nodes */
    int mesh;    /**< whose pitches its harmonics are of */
    number_channel sums;
};

static bool takes(const number_sums *sums, int first, int n)
{
    bool any = false;
    for (int i = 0; i < n; i++) {
        any = any || sums->taken[first + i];
    }
    return any;
}

/** Whether a quantity has to be followed: the dynamic factor is made of the force. */
static bool follows(const number_sums *sums, int quantity)
{
    return takes(sums, number_row(quantity, (number_tells)0), N_TELLS) ||
           (quantity == NUMBER_FORCE && sums->taken[number_row_of_contact(NUMBER_DYNAMIC)]);
}

/** A channel for each element of the quantities that are requested. */
static void open_channels(number_sums *sums, memory_pool *pool)
{
    const model_names *names = &model_about(sums->model)->names;
    int counts[N_NUMBER_QUANTITIES], n = 0;
    for (int quantity = 0; quantity < N_NUMBER_QUANTITIES; quantity++) {
        counts[quantity] = follows(sums, quantity) ? number_quantity_elements(names, quantity) : 0;
        n += counts[quantity];
    }
    if (n == 0) { /* whether the motion has settled is judged by a quantity */
        n = counts[NUMBER_ERROR] = names->meshes.n;
    }
    sums->channels = pool_calloc(pool, (size_t)n, sizeof *sums->channels);
    for (int quantity = 0; quantity < N_NUMBER_QUANTITIES; quantity++) {
        const int value = counts[quantity] > 0 ? step_nodes_want(&sums->nodes, number_quantity(quantity)) : -1;
        for (int i = 0; i < counts[quantity] && value >= 0; i++) {
            sums_channel *one = &sums->channels[sums->n_channels++];
            *one = (sums_channel){.row = number_row(quantity, (number_tells)0), .element = i, .value = value + i};
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
    step_nodes_init(&self->nodes, model, pool);
    mesh_numbers_want(own, &self->nodes, &self->places);
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

/** The mesh whose pitches the harmonics of a wheel are of: the window's, `preferred`, if it is one of its, else its first. */
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
    for (int i = 0; i < self->n_channels; i++) {
        sums_channel *one = &self->channels[i];
        const int quantity = one->row / N_TELLS;
        const int wheel = quantity == NUMBER_AXLE ? one->element / 2 : one->element;
        one->mesh = quantity == NUMBER_ACCELEROMETER                     ? preferred
                    : quantity == NUMBER_SPIN || quantity == NUMBER_AXLE ? mesh_of_wheel(self, values, wheel, preferred)
                                                                         : one->element;
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

void number_sums_followed(const number_sums *self, int channel, number_followed *followed)
{
    const sums_channel *one = &self->channels[channel];
    const mesh_sums *mesh = &self->meshes[one->mesh].total;
    *followed = (number_followed){.quantity = one->row / N_TELLS, .element = one->element};
    number_channel_conclude(&one->sums, mesh->time, mesh->pitches, &followed->numbers);
    followed->has_halves = number_blocks_halves(&self->blocks, channel, &followed->halves);
    followed->halves.first += one->sums.shift;
    followed->halves.second += one->sums.shift;
}

static void conclude_channel(const number_sums *self, const sums_channel *one, const int *offsets, double *values)
{
    channel_numbers told = {0};
    const mesh_sums *mesh = &self->meshes[one->mesh].total;
    const bool is_force = one->row == number_row(NUMBER_FORCE, (number_tells)0);
    number_channel_conclude(&one->sums, mesh->time, mesh->pitches, &told);
    told.low =
        is_force && told.low < 0 ? 0 : told.low; /* flanks only push; the rest is rounding at the ends of steps */
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

void number_sums_conclude(const number_sums *self, const int *offsets, double *values)
{
    for (int i = 0; i < self->n_channels; i++) {
        conclude_channel(self, &self->channels[i], offsets, values);
    }
    for (int m = 0; m < self->n_meshes; m++) {
        mesh_numbers_conclude(&self->meshes[m], m, &self->places, self->model, self->taken, offsets, values);
    }
}
