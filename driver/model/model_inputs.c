#include "model/model_inputs.h"

#include "model/model_kernel.h"

#include <stdio.h>

int model_inputs(const model *model, memory_arena *arena, model_input **inputs)
{
    int n = 0;
    evl_input input;
    while (evl_gearbox_input(model->gearbox, n, &input)) {
        n++;
    }
    model_input *all = *inputs = arena_calloc(arena, (size_t)n, sizeof *all);
    for (int i = 0; evl_gearbox_input(model->gearbox, i, &input); i++) {
        all[i] = (model_input){.load = input.load,
                               .wheel = input.wheel,
                               .is_speed = input.is_speed,
                               .value = input.value,
                               .path = arena_printf(arena, "wheels.%s.loads.%d.value",
                                                    model->about.names.wheels.names[input.wheel], input.index)};
    }
    return n;
}

void model_feed(const model *model, int load, double value, double rate)
{
    evl_gearbox_feed(model->gearbox, load, value, rate);
}

double model_wheel_speed(const model *model, int wheel, const dae_state *state)
{
    return evl_gearbox_wheel_speed(model->gearbox, wheel, state->t, state->y);
}

int model_rates(const model *model, dae_state *state, char message[DAE_MESSAGE_LENGTH])
{
    evl_status status;
    const int code =
        evl_gearbox_derivative(model->gearbox, state->t, state->y, state->integers, state->reals, state->yp, &status);
    return model_check_status(model, code, &status, message);
}
