/* The kernel's own integrator as the stepper of the gearbox's dae. */
#include "model_kernel.h"

#include <stdio.h>

static int answer(int code, const evl_status *status, char message[DAE_MESSAGE_LENGTH])
{
    if (code == EVL_OK) {
        return DAE_OK;
    }
    (void)snprintf(message, DAE_MESSAGE_LENGTH, "%s", status->message);
    return DAE_FATAL;
}

static void *create(const void *self, double tolerance, double max_step, char message[DAE_MESSAGE_LENGTH])
{
    const model *model = self;
    evl_status status;
    evl_radau *radau = evl_radau_create(model->gearbox, model->dae.scale, tolerance, max_step, &status);
    if (radau == NULL) {
        (void)snprintf(message, DAE_MESSAGE_LENGTH, "%s", status.message);
    }
    return radau;
}

static void destroy(void *stepper)
{
    evl_radau *radau = stepper;
    evl_radau_delete(&radau);
}

static int start(void *stepper, const dae_state *state, char message[DAE_MESSAGE_LENGTH])
{
    evl_status status;
    const int code = evl_radau_start(stepper, state->t, state->y, state->integers, state->reals, &status);
    return answer(code, &status, message);
}

static int advance(void *stepper, double t_stop, dae_state *state, int *fired, dae_outcome *outcome,
                   char message[DAE_MESSAGE_LENGTH])
{
    static const dae_outcome outcomes[] = {
        [EVL_RADAU_STEP] = DAE_STEPPED, [EVL_RADAU_EVENT] = DAE_AT_EVENT, [EVL_RADAU_STOP] = DAE_AT_STOP};
    evl_status status;
    int came_to = EVL_RADAU_STEP;
    const int code = evl_radau_advance(stepper, t_stop, &state->t, state->y, fired, &came_to, &status);
    *outcome = outcomes[came_to];
    return answer(code, &status, message);
}

static void interpolate(const void *stepper, double t, double *y)
{
    evl_radau_interpolate(stepper, t, y);
}

static int look(void *stepper, const double *high, const double *low)
{
    return evl_radau_look(stepper, high, low);
}

static void candidate(const void *stepper, int index, dae_candidate *candidate)
{
    evl_candidate from;
    evl_radau_candidate(stepper, index, &from);
    *candidate = (dae_candidate){from.channel, from.sense, from.t, from.left, from.right, from.value};
}

static void restart(void *stepper, const dae_state *state)
{
    evl_radau_restart(stepper, state->t, state->y, state->integers, state->reals);
}

static void redo(void *stepper, dae_state *state)
{
    evl_radau_redo(stepper, &state->t, state->y);
}

static void counts(const void *stepper, dae_stepper_counts *counts)
{
    evl_radau_counts now;
    evl_radau_get_counts(stepper, &now);
    *counts = (dae_stepper_counts){.steps = now.steps,
                                   .rejections = now.rejections,
                                   .evaluations = now.evaluations,
                                   .iterations = now.iterations,
                                   .jacobians = now.jacobians,
                                   .factorisations = now.factorisations,
                                   .root_evaluations = now.root_evaluations};
}

static void growth(const void *stepper, dae_growth *growth)
{
    evl_radau_growth found;
    evl_radau_get_growth(stepper, &found);
    *growth = (dae_growth){.t = found.t, .rate = found.rate, .frequency = found.frequency};
}

const dae_stepper *model_radau(const model *model)
{
    static const dae_stepper radau = {.create = create,
                                      .destroy = destroy,
                                      .start = start,
                                      .advance = advance,
                                      .interpolate = interpolate,
                                      .look = look,
                                      .candidate = candidate,
                                      .restart = restart,
                                      .redo = redo,
                                      .counts = counts,
                                      .growth = growth};
    return evl_radau_serves(model->gearbox, NULL) == EVL_OK ? &radau : NULL;
}
