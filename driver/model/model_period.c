#include "model/model_period.h"

#include "model/model_kernel.h"

#include <stdio.h>
#include <string.h>

static evl_period to_kernel(const model_period *period)
{
    return (evl_period){period->pitches, period->sense, period->by_time, period->time};
}

bool model_find_period(const model *model, model_period *period, model_message *error)
{
    evl_status status = {.index = -1};
    evl_period found;
    const bool good = evl_gearbox_period(model->gearbox, &found, &status) == EVL_OK;
    if (!good) {
        model_explain(model, &status, error);
    }
    *period = (model_period){found.pitches, found.sense, found.by_time, found.time};
    return good;
}

void model_take_back(const model *model, const model_period *period, int periods, dae_state *state)
{
    const evl_period own = to_kernel(period);
    evl_gearbox_take_back(model->gearbox, &own, periods, state->y, state->integers, state->reals);
}

double model_distance(const model *model, const dae_state *a, const dae_state *b)
{
    return evl_gearbox_distance(model->gearbox, model->about.dae.scale, a->y, a->integers, a->reals, b->y, b->integers,
                                b->reals);
}

bool model_take_over(const model *model, const dae *other, const dae_state *from, double t, dae_state *to,
                     char message[DAE_MESSAGE_LENGTH])
{
    const dae *own = &model->about.dae;
    evl_status status = {.index = -1};
    if (own->n != other->n) {
        (void)snprintf(message, DAE_MESSAGE_LENGTH,
                       "the gearbox has %d states and had %d: the motion cannot be transferred", own->n, other->n);
        return false;
    }
    const bool alike = own->n_integers == other->n_integers && own->n_reals == other->n_reals;
    to->t = t;
    memcpy(to->y, from->y, (size_t)own->n * sizeof *to->y);
    memcpy(to->integers, from->integers, (alike ? (size_t)own->n_integers : 1) * sizeof *to->integers);
    memcpy(to->reals, from->reals, (alike ? (size_t)own->n_reals : 0) * sizeof *to->reals);
    const int code = evl_gearbox_take_over(model->gearbox, alike, t, to->y, to->yp, to->integers, to->reals, &status);
    return model_check_status(model, code, &status, message) == DAE_OK;
}
