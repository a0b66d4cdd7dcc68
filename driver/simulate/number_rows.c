#include "simulate/number_rows.h"

#include "base/words.h"

#include <math.h>
#include <string.h>

#define FORMULA(key, formula)                                                                                          \
    static double find_##key(const number_source *from, int n)                                                         \
    {                                                                                                                  \
        const channel_window *w = from->window;                                                                        \
        const mesh_sums *s = &from->mesh->total;                                                                       \
        (void)w, (void)s, (void)n;                                                                                     \
        return formula;                                                                                                \
    }
#define OF_QUANTITY(of, key, units, text, dims, formula) FORMULA(key, formula)
#define OF_MESH(key, units, text, quantity, outputs, formula) FORMULA(key, formula)
NUMBERS_OF_QUANTITY(OF_QUANTITY, , , , )
NUMBERS_OF_MESH(OF_MESH)
#undef OF_QUANTITY
#undef OF_MESH

#define QUANTITY(of, units, text, dims, least) {#of, dims, least},
const number_quantity number_quantities[N_NUMBER_QUANTITIES] = {NUMBER_QUANTITIES(QUANTITY)};
#undef QUANTITY

#define OF_QUANTITY(of, key, units, text, dims, formula)                                                               \
    {#of "_" #key, units, text, dims, #of, QUANTITY_##of, 0, find_##key},
#define QUANTITY(of, units, text, dims, least) NUMBERS_OF_QUANTITY(OF_QUANTITY, of, units, text, dims)
#define OF_MESH(key, units, text, quantity, outputs, formula)                                                          \
    {#key, units, text, "mesh", "contact", QUANTITY_##quantity, outputs, find_##key},
const number_row number_rows[N_NUMBER_ROWS] = {NUMBER_QUANTITIES(QUANTITY) NUMBERS_OF_MESH(OF_MESH)};

const name_list *number_elements(const char *dims, const model_names *names)
{
    return words_contain(dims, "wheel")           ? &names->wheels
           : words_contain(dims, "accelerometer") ? &names->accelerometers
                                                  : &names->meshes;
}

int number_count(const char *dims, const model_names *names)
{
    return number_elements(dims, names)->n * (words_contain(dims, "axis") ? 2 : 1) *
           (words_contain(dims, "harmonic") ? NUMBER_HARMONICS : 1);
}

int number_rows_place(const model_names *names, model_output *rows)
{
    int n = 0;
    for (int i = 0; i < N_NUMBER_ROWS; i++) {
        const number_row *row = &number_rows[i];
        rows[i] = (model_output){.name = row->name,
                                 .units = row->units,
                                 .symbol = "",
                                 .long_name = row->text,
                                 .dims = row->dims,
                                 .is_static = true,
                                 .offset = n,
                                 .count = number_count(row->dims, names)};
        n += rows[i].count;
    }
    return n;
}

const char *number_rows_take(int n_words, const char *const *words, bool *taken)
{
    for (int w = 0; w < n_words; w++) {
        bool is_known = false;
        for (int i = 0; i < N_NUMBER_ROWS; i++) {
            const char *const names[] = {"all", number_rows[i].group, number_rows[i].name};
            const bool is_named = words_index(words[w], 3, names) >= 0;
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
        words[2 + i] = number_quantities[i].name;
    }
    return words_join(N_NUMBER_QUANTITIES + 2, words, ", ");
}
