#include "model/model_inputs.h"

#include "model/model_kernel.h"

#include <stdio.h>

int model_inputs(const model *model, memory_pool *pool, model_input **inputs)
{
    int n = 0;
    evl_input input;
    while (evl_gearbox_input(model->gearbox, n, &input)) {
        n++;
    }
    model_input *all = *inputs = pool_calloc(pool, (size_t)n, sizeof *all);
    for (int i = 0; evl_gearbox_input(model->gearbox, i, &input); i++) {
        all[i] = (model_input){.load = input.load,
                               .wheel = input.wheel,
                               .is_speed = input.is_speed,
                               .value = input.value,
                               .path = pool_printf(pool, "wheels.%s.loads.%d.value",
                                                   model->about.names.wheels.names[input.wheel], input.place)};
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

bool model_loads_agree(const model *model, const dae_state *state, double part, char message[DAE_MESSAGE_LENGTH])
{
    static const char *const formulas[] = {[EVL_FORMULA_IN_LANES] = "those for eight states at once",
                                           [EVL_FORMULA_OF_SPIN] = "what a change of its speed adds"};
    evl_load_conflict found;
    if (!evl_gearbox_load_conflict(model->gearbox, state->t, state->y, state->integers, part, &found)) {
        return true;
    }
    (void)snprintf(message, DAE_MESSAGE_LENGTH,
                   "the torque of a load of wheel '%.60s' at %.9g rad/s is %.9g N m by its formula for one state and "
                   "%.9g N m by %s",
                   model->about.names.wheels.names[found.wheel], found.omega, found.here, found.other,
                   formulas[found.formula]);
    return false;
}

int model_rates(const model *model, dae_state *state, char message[DAE_MESSAGE_LENGTH])
{
    evl_status status;
    const int code =
        evl_gearbox_derivative(model->gearbox, state->t, state->y, state->integers, state->reals, state->yp, &status);
    return model_answer(model, code, &status, message);
}
