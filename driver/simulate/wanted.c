#include "simulate/wanted.h"

void wanted_init(wanted_outputs *wanted, const model *model, bool all, memory_pool *pool)
{
    const model_facts *about = model_about(model);
    *wanted = (wanted_outputs){.model = model, .all = all, .n_values = all ? about->n_values : 0};
    wanted->outputs = pool_calloc(pool, (size_t)about->n_outputs, sizeof *wanted->outputs);
    wanted->places = pool_calloc(pool, (size_t)about->n_outputs, sizeof *wanted->places);
    for (int i = 0; i < about->n_outputs; i++) {
        wanted->places[i] = all ? about->outputs[i].offset : -1;
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
