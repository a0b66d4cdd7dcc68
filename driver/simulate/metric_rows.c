#include "simulate/metric_rows.h"

#include "base/words.h"

#include <math.h>
#include <string.h>

/** Largest quasi-static force of a tooth pair under the mean torque of its mesh. */
static double find_static_force(const metric_source *from)
{
    const static_span span = mesh_metrics_span(from->mesh);
    return model_static_pair_force(from->model, from->index, &span);
}

/** Largest quasi-static root stress of a wheel under the mean torques of its meshes. Equation RS8. */
static double find_static_root(const metric_source *from)
{
    const int n = model_about(from->model)->names.meshes.n;
    CLEANUP_FREE static_span *spans = xcalloc((size_t)n, sizeof *spans);
    for (int m = 0; m < n; m++) {
        spans[m] = mesh_metrics_span(&from->mesh[m]);
    }
    return model_static_root(from->model, from->wheel, spans);
}

#define FORMULA(key, formula)                                                                                          \
    static double find_##key(const metric_source *from, int n)                                                         \
    {                                                                                                                  \
        const channel_window *w = from->window;                                                                        \
        const mesh_sums *s = &from->mesh->total;                                                                       \
        const root_extremes r = from->root;                                                                            \
        const temperature_extremes c = from->temperature;                                                              \
        (void)w, (void)s, (void)r, (void)c, (void)n;                                                                   \
        return formula;                                                                                                \
    }
#define OF_QUANTITY(of, key, units, text, dims, formula) FORMULA(key, formula)
#define OF_MESH(key, units, text, quantity, outputs, formula) FORMULA(key, formula)
METRICS_OF_QUANTITY(OF_QUANTITY, , , , )
#define OF_REQUEST(key, units, text, outputs, formula) FORMULA(key, formula)
METRICS_OF_MESH(OF_MESH)
METRICS_OF_ROOT(OF_REQUEST)
METRICS_OF_TEMPERATURE(OF_REQUEST)
#undef OF_QUANTITY
#undef OF_MESH
#undef OF_REQUEST

const sought_extreme root_extremes_sought[N_ROOT_EXTREMES] = {{"root_stress_max", 1}, {"root_stress_min", -1}};
const sought_extreme temperature_extremes_sought[N_TEMPERATURE_EXTREMES] = {{"pair_flash_temperature", 1},
                                                                            {"pair_contact_temperature", 1}};

#define QUANTITY(of, units, text, dims, least) {#of, dims, least},
const metric_quantity metric_quantities[N_METRIC_QUANTITIES] = {METRIC_QUANTITIES(QUANTITY)};
#undef QUANTITY

#define OF_QUANTITY(of, key, units, text, dims, formula)                                                               \
    {#of "_" #key, units, text, dims, #of, QUANTITY_##of, 0, METRIC_OF_ALL_MODELS, find_##key},
#define QUANTITY(of, units, text, dims, least) METRICS_OF_QUANTITY(OF_QUANTITY, of, units, text, dims)
#define OF_MESH(key, units, text, quantity, outputs, formula)                                                          \
    {#key, units, text, "mesh", "contact", QUANTITY_##quantity, outputs, METRIC_OF_ALL_MODELS, find_##key},
#define OF_ROOT(key, units, text, outputs, formula)                                                                    \
    {#key, units, text, "wheel", "root_stress", QUANTITY_none, outputs, METRIC_OF_ROOTS, find_##key},
#define OF_TEMPERATURE(key, units, text, outputs, formula)                                                             \
    {#key, units, text, "mesh", "temperature", QUANTITY_none, outputs, METRIC_OF_TEMPERATURES, find_##key},
const metric_row metric_rows[N_METRIC_ROWS] = {METRIC_QUANTITIES(QUANTITY) METRICS_OF_MESH(OF_MESH)
                                                   METRICS_OF_ROOT(OF_ROOT) METRICS_OF_TEMPERATURE(OF_TEMPERATURE)};

const name_list *metric_elements(const char *dims, const model_names *names)
{
    return words_contain(dims, "wheel")           ? &names->wheels
           : words_contain(dims, "accelerometer") ? &names->accelerometers
                                                  : &names->meshes;
}

int metric_count(const char *dims, const model_names *names)
{
    return metric_elements(dims, names)->n * (words_contain(dims, "axis") ? 2 : 1) *
           (words_contain(dims, "harmonic") ? METRIC_HARMONICS : 1);
}

int metric_rows_lay_out(const model_names *names, model_output *rows)
{
    int n = 0;
    for (int i = 0; i < N_METRIC_ROWS; i++) {
        const metric_row *row = &metric_rows[i];
        rows[i] = (model_output){.name = row->name,
                                 .units = row->units,
                                 .symbol = "",
                                 .long_name = row->text,
                                 .dims = row->dims,
                                 .is_static = true,
                                 .offset = n,
                                 .count = metric_count(row->dims, names)};
        n += rows[i].count;
    }
    return n;
}

bool metric_row_exists(const model *model, int row)
{
    static const char *const outputs[N_METRIC_REQUESTS] = {[METRIC_OF_ROOTS] = "root_stress_max",
                                                           [METRIC_OF_TEMPERATURES] = "pair_flash_temperature"};
    const char *output = outputs[metric_rows[row].request];
    const model_output *found = output == NULL ? NULL : model_output_named(model, output);
    return output == NULL || (found != NULL && found->count > 0);
}

bool metric_rows_request(const bool *taken, metric_request request)
{
    int i = 0;
    while (i < N_METRIC_ROWS && !(taken[i] && metric_rows[i].request == request)) {
        i++;
    }
    return i < N_METRIC_ROWS;
}

const char *metric_rows_select(int n_words, const char *const *words, bool *taken)
{
    for (int w = 0; w < n_words; w++) {
        bool is_known = false;
        for (int i = 0; i < N_METRIC_ROWS; i++) {
            const char *const names[] = {metric_rows[i].group, metric_rows[i].name, "all"};
            const bool is_named =
                words_index(words[w], metric_rows[i].request == METRIC_OF_ALL_MODELS ? 3 : 2, names) >= 0;
            taken[i] = taken[i] || is_named;
            is_known = is_known || is_named;
        }
        if (!is_known) {
            return words[w];
        }
    }
    return NULL;
}

char *metric_rows_words(void)
{
    enum { N_GROUPS = 4 };
    const char *words[N_METRIC_QUANTITIES + N_GROUPS] = {"all", "contact", "root_stress", "temperature"};
    for (int i = 0; i < N_METRIC_QUANTITIES; i++) {
        words[N_GROUPS + i] = metric_quantities[i].name;
    }
    return words_join(N_METRIC_QUANTITIES + N_GROUPS, words, ", ");
}
