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
        (void)w, (void)s, (void)r, (void)n;                                                                            \
        return formula;                                                                                                \
    }
#define OF_QUANTITY(of, key, units, text, dims, formula) FORMULA(key, formula)
#define OF_MESH(key, units, text, quantity, outputs, formula) FORMULA(key, formula)
METRICS_OF_QUANTITY(OF_QUANTITY, , , , )
#define OF_ROOT(key, units, text, outputs, formula) FORMULA(key, formula)
METRICS_OF_MESH(OF_MESH)
METRICS_OF_ROOT(OF_ROOT)
#undef OF_QUANTITY
#undef OF_MESH
#undef OF_ROOT

#define QUANTITY(of, units, text, dims, least) {#of, dims, least},
const metric_quantity metric_quantities[N_METRIC_QUANTITIES] = {METRIC_QUANTITIES(QUANTITY)};
#undef QUANTITY

#define OF_QUANTITY(of, key, units, text, dims, formula)                                                               \
    {#of "_" #key, units, text, dims, #of, QUANTITY_##of, 0, false, find_##key},
#define QUANTITY(of, units, text, dims, least) METRICS_OF_QUANTITY(OF_QUANTITY, of, units, text, dims)
#define OF_MESH(key, units, text, quantity, outputs, formula)                                                          \
    {#key, units, text, "mesh", "contact", QUANTITY_##quantity, outputs, false, find_##key},
#define OF_ROOT(key, units, text, outputs, formula)                                                                    \
    {#key, units, text, "wheel", "root_stress", QUANTITY_none, outputs, true, find_##key},
const metric_row metric_rows[N_METRIC_ROWS] = {METRIC_QUANTITIES(QUANTITY) METRICS_OF_MESH(OF_MESH)
                                                   METRICS_OF_ROOT(OF_ROOT)};

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

int metric_rows_of(const model *model)
{
    const model_output *found = model_output_named(model, metric_rows[METRIC_root_stress_max].name);
    return found != NULL && found->count > 0 ? N_METRIC_ROWS : METRICS_WITHOUT_ROOTS;
}

const char *metric_rows_select(int n_words, const char *const *words, bool *taken)
{
    for (int w = 0; w < n_words; w++) {
        bool is_known = false;
        for (int i = 0; i < N_METRIC_ROWS; i++) {
            const char *const names[] = {metric_rows[i].group, metric_rows[i].name, "all"};
            const bool is_named = words_index(words[w], metric_rows[i].is_of_roots ? 2 : 3, names) >= 0;
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
    const char *words[N_METRIC_QUANTITIES + 3] = {"all", "contact", "root_stress"};
    for (int i = 0; i < N_METRIC_QUANTITIES; i++) {
        words[3 + i] = metric_quantities[i].name;
    }
    return words_join(N_METRIC_QUANTITIES + 3, words, ", ");
}
