/* Sparsity pattern of the gearbox's Jacobian. */
#include "base/memory.h"
#include "model/model_kernel.h"

#include <stdlib.h>

typedef struct {
    const model *model;
    evl_pattern *pattern;
} model_entries;

static void *create(const void *self, int *n_entries)
{
    const model *model = self;
    evl_pattern *pattern = evl_pattern_create(model->gearbox, n_entries);
    if (pattern == NULL) {
        return NULL;
    }
    model_entries *entries = xcalloc(1, sizeof *entries);
    *entries = (model_entries){model, pattern};
    return entries;
}

static void destroy(void *pattern)
{
    model_entries *entries = pattern;
    evl_pattern_delete(&entries->pattern);
    free(entries);
}

static void places(const void *pattern, int *rows, int *columns)
{
    const model_entries *entries = pattern;
    evl_pattern_places(entries->pattern, rows, columns);
}

static int jacobian(const void *pattern, const dae_state *state, double cj, double *values,
                    char message[DAE_MESSAGE_LENGTH])
{
    const model_entries *entries = pattern;
    evl_status status;
    const int code = evl_pattern_jacobian(entries->pattern, state->t, cj, state->y, state->yp, state->integers,
                                          state->reals, values, &status);
    return model_answer(entries->model, code, &status, message);
}

const dae_pattern *model_pattern(void)
{
    static const dae_pattern pattern = {.create = create, .destroy = destroy, .places = places, .jacobian = jacobian};
    return &pattern;
}
