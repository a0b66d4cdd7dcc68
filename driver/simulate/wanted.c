#include "simulate/wanted.h"

void wanted_init(wanted_outputs *wanted, const model *model, memory_pool *pool)
{
    const int n = model_about(model)->n_outputs;
    *wanted = (wanted_outputs){.model = model};
    wanted->outputs = pool_calloc(pool, (size_t)n, sizeof *wanted->outputs);
    wanted->places = pool_calloc(pool, (size_t)n, sizeof *wanted->places);
    for (int i = 0; i < n; i++) {
        wanted->places[i] = -1;
    }
}

bool wanted_has(const wanted_outputs *wanted, int index)
{
    return wanted->places[index] >= 0 && model_about(wanted->model)->outputs[index].count > 0;
}

int wanted_add(wanted_outputs *wanted, const char *name)
{
    const model_output *found = model_output_named(wanted->model, name);
    if (found == NULL || found->count == 0) {
        return -1;
    }
    const int index = (int)(found - model_about(wanted->model)->outputs);
    if (wanted->places[index] < 0) {
        wanted->places[index] = wanted->n_values;
        wanted->outputs[wanted->n++] = index;
        wanted->n_values += found->count;
    }
    return wanted->places[index];
}
