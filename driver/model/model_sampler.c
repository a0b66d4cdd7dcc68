#include "model/model.h"

#include "base/memory.h"
#include "model/model_kernel.h"

#include <stdlib.h>

struct model_sampler {
    const model *model;
    evl_sampler *sampler;
};

model_sampler *model_sampler_create(const model *model, int n, const int *requested)
{
    model_sampler *self = xcalloc(1, sizeof *self);
    *self = (model_sampler){model, evl_sampler_create(model->gearbox, n, requested)};
    return self;
}

void model_sampler_delete(model_sampler **pointer)
{
    model_sampler *self = *pointer;
    *pointer = NULL;
    if (self != NULL) {
        evl_sampler_delete(&self->sampler);
        free(self);
    }
}

int model_sampler_ask(const model_sampler *self, int n, const double *t, const double *y, const dae_state *discrete,
                      double *values, char message[DAE_MESSAGE_LENGTH])
{
    evl_status status;
    const int code =
        evl_sampler_ask(self->sampler, n, n, t, y, discrete->integers, discrete->reals, false, values, &status);
    return model_check_status(self->model, code, &status, message);
}

int model_sampler_at(const model_sampler *self, bool check, const dae_state *state, double *values,
                     char message[DAE_MESSAGE_LENGTH])
{
    evl_status status;
    const int code = evl_sampler_ask(self->sampler, 1, 1, &state->t, state->y, state->integers, state->reals, check,
                                     values, &status);
    return model_check_status(self->model, code, &status, message);
}

bool model_sampler_in_lanes(const model_sampler *self)
{
    return evl_sampler_in_lanes(self->sampler);
}

int model_sampler_lanes(const model_sampler *self, int n, bool check, const double *t, const double *y,
                        const dae_state *discrete, double *values, char message[DAE_MESSAGE_LENGTH])
{
    evl_status status;
    const int code =
        evl_sampler_ask(self->sampler, DAE_LANES, n, t, y, discrete->integers, discrete->reals, check, values, &status);
    return model_check_status(self->model, code, &status, message);
}

_Static_assert(+MODEL_ROOT_POINTS == +EVL_ROOT_POINTS, "as in the kernel");

int model_root_teeth(const model *model)
{
    return evl_gearbox_root_teeth(model->gearbox);
}

int model_sampler_root_points(const model_sampler *self, int wheel, int most, int n, double *values)
{
    return evl_sampler_root_points(self->sampler, wheel, most, n, values);
}
