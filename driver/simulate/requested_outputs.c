#include "simulate/requested_outputs.h"

void requested_outputs_init(requested_outputs *requested, const model *model, memory_arena *arena)
{
    const int n = model_about(model)->n_outputs;
    *requested = (requested_outputs){.model = model};
    requested->outputs = arena_calloc(arena, (size_t)n, sizeof *requested->outputs);
    requested->offsets = arena_calloc(arena, (size_t)n, sizeof *requested->offsets);
    for (int i = 0; i < n; i++) {
        requested->offsets[i] = -1;
    }
}

bool requested_outputs_has(const requested_outputs *requested, int index)
{
    return requested->offsets[index] >= 0 && model_about(requested->model)->outputs[index].count > 0;
}

int requested_outputs_add(requested_outputs *requested, const char *name)
{
    const model_output *found = model_output_named(requested->model, name);
    if (found == NULL || found->count == 0) {
        return -1;
    }
    const int index = (int)(found - model_about(requested->model)->outputs);
    if (requested->offsets[index] < 0) {
        requested->offsets[index] = requested->n_values;
        requested->outputs[requested->n++] = index;
        requested->n_values += found->count;
    }
    return requested->offsets[index];
}
