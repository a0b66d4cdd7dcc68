#include "simulate/number_rows.h"

#include "base/words.h"
#include "simulate/number_channel.h"

#include <string.h>

static const struct {
    const char *name, *units, *text, *dims;
} quantities[N_NUMBER_QUANTITIES] = {
    [NUMBER_ERROR] = {"transmission_error", "m", "transmission error", "mesh"},
    [NUMBER_FORCE] = {"normal_force", "N", "normal force of all tooth pairs", "mesh"},
    [NUMBER_SPIN] = {"angular_acceleration", "rad s-2", "angular acceleration", "wheel"},
    [NUMBER_AXLE] = {"centre_acceleration", "m s-2", "acceleration of the axle", "wheel axis"},
    [NUMBER_ACCELEROMETER] = {"accelerometer_acceleration", "m s-2", "acceleration at the accelerometer",
                              "accelerometer"},
};

/** units NULL: those of the quantity. */
static const struct {
    const char *name, *units, *text;
} tells[N_TELLS] = {
    [TELLS_MEAN] = {"mean", NULL, "mean over time of the"},
    [TELLS_DEVIATION] = {"standard_deviation", NULL, "standard deviation over time of the"},
    [TELLS_RMS] = {"rms", NULL, "root mean square over time of the"},
    [TELLS_RANGE] = {"peak_to_peak", NULL, "peak to peak"},
    [TELLS_HIGH] = {"max", NULL, "largest"},
    [TELLS_LOW] = {"min", NULL, "smallest"},
    [TELLS_CREST] = {"crest_factor", "1",
                     "crest factor (largest distance from the mean over the standard deviation) of the"},
    [TELLS_KURTOSIS] = {"kurtosis", "1", "kurtosis (3 for a normal distribution) of the"},
    [TELLS_AMPLITUDE] = {"amplitude", NULL, "amplitudes of the mesh orders of the"},
    [TELLS_PHASE] = {"phase", "rad", "phases of the mesh orders, A cos(2 pi n xi - phase), of the"},
};

static const struct {
    const char *name, *units, *text;
} of_contact[N_OF_CONTACT] = {
    [NUMBER_NO_CONTACT] = {"share_no_contact", "1", "share of the time without contact"},
    [NUMBER_ONE_PAIR] = {"share_one_pair", "1", "share of the time with one pair in contact"},
    [NUMBER_TWO_PAIRS] = {"share_two_pairs", "1", "share of the time with two pairs in contact"},
    [NUMBER_MORE_PAIRS] = {"share_more_pairs", "1", "share of the time with three or more pairs in contact"},
    [NUMBER_COAST] = {"share_coast_flanks", "1", "share of the time with a force on the coast flanks"},
    [NUMBER_DYNAMIC] = {"dynamic_factor", "1", "dynamic factor: largest normal force over its mean"},
    [NUMBER_PAIR_FORCE] = {"pair_normal_force_max", "N", "largest normal force of a tooth pair"},
    [NUMBER_PAIR_DYNAMIC] = {"pair_dynamic_factor", "1",
                             "dynamic factor of a tooth pair: largest force over that at rest under the mean torque"},
    [NUMBER_IMPACTS] = {"impacts", "1", "impacts: how often flanks met while no tooth pair was in contact"},
    [NUMBER_IMPACT_SPEED] = {"impact_speed_max", "m s-1", "largest speed at which they met"},
    [NUMBER_IMPACT_ENERGY] = {"impact_energy", "J", "energy of impacts: kinetic energy of all approaches"},
    [NUMBER_ENERGY] = {"transmitted_energy", "J",
                       "energy through the mesh: integral of the size of the driving wheel's power"},
    [NUMBER_RATTLE] = {"rattle_index", "1", "rattle index: energy of impacts over transmitted energy"},
};

const char *number_quantity(int quantity)
{
    return quantities[quantity].name;
}

/** Of what a row tells: the first of its dimensions. */
static const name_list *elements_of(const char *dims, const model_names *names)
{
    return words_contain(dims, "wheel")           ? &names->wheels
           : words_contain(dims, "accelerometer") ? &names->accelerometers
                                                  : &names->meshes;
}

const name_list *number_row_elements(const model_output *row, const model_names *names)
{
    return elements_of(row->dims, names);
}

static bool is_harmonic(int k)
{
    return k == TELLS_AMPLITUDE || k == TELLS_PHASE;
}

int number_quantity_elements(const model_names *names, int quantity)
{
    const char *dims = quantities[quantity].dims;
    return elements_of(dims, names)->n * (words_contain(dims, "axis") ? 2 : 1);
}

int number_rows_offsets(const model_names *names, int offsets[N_NUMBER_ROWS])
{
    int n = 0;
    for (int quantity = 0; quantity < N_NUMBER_QUANTITIES; quantity++) {
        const int count = number_quantity_elements(names, quantity);
        for (int k = 0; k < N_TELLS; k++) {
            offsets[number_row(quantity, (number_tells)k)] = n;
            n += count * (is_harmonic(k) ? NUMBER_HARMONICS : 1);
        }
    }
    for (int i = 0; i < N_OF_CONTACT; i++) {
        offsets[number_row_of_contact((number_of_contact)i)] = n;
        n += names->meshes.n;
    }
    return n;
}

static model_output row_of_quantity(memory_pool *pool, int quantity, int k)
{
    return (model_output){.name = pool_printf(pool, "%s_%s", quantities[quantity].name, tells[k].name),
                          .units = tells[k].units == NULL ? quantities[quantity].units : tells[k].units,
                          .symbol = "",
                          .long_name = pool_printf(pool, "%s %s", tells[k].text, quantities[quantity].text),
                          .dims = is_harmonic(k) ? pool_printf(pool, "%s harmonic", quantities[quantity].dims)
                                                 : quantities[quantity].dims,
                          .is_static = true};
}

int number_rows_place(memory_pool *pool, const model_names *names, model_output *rows)
{
    int offsets[N_NUMBER_ROWS];
    const int n = number_rows_offsets(names, offsets);
    for (int quantity = 0; quantity < N_NUMBER_QUANTITIES; quantity++) {
        for (int k = 0; k < N_TELLS; k++) {
            rows[number_row(quantity, (number_tells)k)] = row_of_quantity(pool, quantity, k);
        }
    }
    for (int i = 0; i < N_OF_CONTACT; i++) {
        rows[number_row_of_contact((number_of_contact)i)] = (model_output){.name = of_contact[i].name,
                                                                           .units = of_contact[i].units,
                                                                           .symbol = "",
                                                                           .long_name = of_contact[i].text,
                                                                           .dims = "mesh",
                                                                           .is_static = true};
    }
    for (int i = 0; i < N_NUMBER_ROWS; i++) {
        rows[i].offset = offsets[i];
        rows[i].count = (i + 1 < N_NUMBER_ROWS ? offsets[i + 1] : n) - offsets[i];
    }
    return n;
}

static bool is_of(const model_output *row, int index, const char *word)
{
    const int quantity = index / N_TELLS;
    const char *group = quantity < N_NUMBER_QUANTITIES ? quantities[quantity].name : "contact";
    return strcmp(word, "all") == 0 || strcmp(word, group) == 0 || strcmp(word, row->name) == 0;
}

const char *number_rows_take(int n_words, const char *const *words, bool *taken)
{
    POOLED memory_pool pool = {NULL};
    model_output rows[N_NUMBER_ROWS];
    (void)number_rows_place(&pool, &(model_names){0}, rows);
    for (int w = 0; w < n_words; w++) {
        bool is_known = false;
        for (int i = 0; i < N_NUMBER_ROWS; i++) {
            const bool is_named = is_of(&rows[i], i, words[w]);
            taken[i] = taken[i] || is_named;
            is_known = is_known || is_named;
        }
        if (!is_known) {
            return words[w];
        }
    }
    return NULL;
}

char *number_rows_words(void)
{
    const char *words[N_NUMBER_QUANTITIES + 2] = {"all", "contact"};
    for (int i = 0; i < N_NUMBER_QUANTITIES; i++) {
        words[2 + i] = quantities[i].name;
    }
    return words_join(N_NUMBER_QUANTITIES + 2, words, ", ");
}
