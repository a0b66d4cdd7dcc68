/* The kernel's own integrator as the stepper of the gearbox's dae. */
#include "base/memory.h"
#include "model/model_kernel.h"

#include <stdlib.h>

typedef struct {
    const model *model;
    evl_radau *radau;
} radau_stepper;

/** Failures of a stepper are not recoverable, since it has already tried smaller steps. */
static int check_status(const radau_stepper *s, int code, const evl_status *status, char message[DAE_MESSAGE_LENGTH])
{
    return model_check_status(s->model, code, status, message) == DAE_OK ? DAE_OK : DAE_FATAL;
}

static void *create(const void *self, double tolerance, double max_step, char message[DAE_MESSAGE_LENGTH])
{
    const model *model = self;
    evl_status status;
    evl_radau *radau = evl_radau_create(model->gearbox, model->about.dae.scale, tolerance, max_step, &status);
    if (radau == NULL) {
        (void)model_check_status(model, status.code, &status, message);
        return NULL;
    }
    radau_stepper *s = xcalloc(1, sizeof *s);
    *s = (radau_stepper){model, radau};
    return s;
}

static void destroy(void *stepper)
{
    radau_stepper *s = stepper;
    evl_radau_delete(&s->radau);
    free(s);
}

static int start(void *stepper, const dae_state *state, char message[DAE_MESSAGE_LENGTH])
{
    const radau_stepper *s = stepper;
    evl_status status;
    const int code = evl_radau_start(s->radau, state->t, state->y, state->integers, state->reals, &status);
    return check_status(s, code, &status, message);
}

static int advance(void *stepper, double t_stop, dae_state *state, int *fired, dae_outcome *outcome,
                   char message[DAE_MESSAGE_LENGTH])
{
    const radau_stepper *s = stepper;
    static const dae_outcome outcomes[] = {
        [EVL_RADAU_STEP] = DAE_STEPPED, [EVL_RADAU_EVENT] = DAE_AT_EVENT, [EVL_RADAU_STOP] = DAE_AT_STOP};
    evl_status status;
    int came_to = EVL_RADAU_STEP;
    const int code = evl_radau_advance(s->radau, t_stop, &state->t, state->y, fired, &came_to, &status);
    *outcome = outcomes[came_to];
    return check_status(s, code, &status, message);
}

static bool interpolate(const void *stepper, double t, double *y)
{
    const radau_stepper *s = stepper;
    evl_radau_interpolate(s->radau, t, y);
    return true;
}

static bool interpolate_some(void *stepper, double t, int n, const int *states, double *y)
{
    const radau_stepper *s = stepper;
    evl_radau_interpolate_some(s->radau, t, n, states, y);
    return true;
}

static void interpolate_lanes(const void *stepper, const double *t, double *y)
{
    _Static_assert(DAE_LANES - EVL_LANES == 0, "as many as the kernel's");
    const radau_stepper *s = stepper;
    evl_radau_interpolate_lanes(s->radau, t, y);
}

static int look(void *stepper, const double *high, const double *low)
{
    const radau_stepper *s = stepper;
    return evl_radau_look(s->radau, high, low);
}

static void candidate(const void *stepper, int index, dae_candidate *candidate)
{
    const radau_stepper *s = stepper;
    evl_candidate from;
    evl_radau_candidate(s->radau, index, &from);
    *candidate = (dae_candidate){from.channel, from.sense, from.t, from.left, from.right, from.value};
}

static void restart(void *stepper, const dae_state *state)
{
    const radau_stepper *s = stepper;
    evl_radau_restart(s->radau, state->t, state->y, state->integers, state->reals);
}

static void redo(void *stepper, dae_state *state)
{
    const radau_stepper *s = stepper;
    evl_radau_redo(s->radau, &state->t, state->y);
}

static void counts(const void *stepper, integrate_counts *counts)
{
    const radau_stepper *s = stepper;
    evl_radau_counts now;
    evl_radau_get_counts(s->radau, &now);
    counts->steps = now.steps;
    counts->rejections = now.rejections;
    counts->residuals = now.evaluations;
    counts->newton_iterations = now.iterations;
    counts->jacobians = now.jacobians;
    counts->linear_setups = now.factorisations;
    counts->roots_evaluated = now.root_evaluations;
    counts->growth = (dae_growth){.t = now.growth_t, .rate = now.growth_rate, .frequency = now.growth_frequency};
}

static void serialize(void *stepper, archive *archive)
{
    const radau_stepper *s = stepper;
    int64_t n = archive->is_reading ? 0 : evl_radau_serialize(s->radau, EVL_SERIALIZE_MEASURE, 0, NULL);
    SERIALIZE(archive, n);
    const bool is_sensible = n > 0 && (uint64_t)n < SIZE_MAX / sizeof n;
    int64_t *words = is_sensible ? archive_take(archive, (size_t)n * sizeof n) : NULL;
    archive->has_failed =
        words == NULL ||
        evl_radau_serialize(s->radau, archive->is_reading ? EVL_SERIALIZE_READ : EVL_SERIALIZE_WRITE, n, words) != n;
}

const dae_stepper *model_radau(const model *model)
{
    static const dae_stepper radau = {.create = create,
                                      .destroy = destroy,
                                      .start = start,
                                      .advance = advance,
                                      .interpolate = interpolate,
                                      .interpolate_some = interpolate_some,
                                      .interpolate_lanes = interpolate_lanes,
                                      .look = look,
                                      .candidate = candidate,
                                      .restart = restart,
                                      .redo = redo,
                                      .counts = counts,
                                      .serialize = serialize};
    return evl_radau_serves(model->gearbox, NULL) == EVL_OK ? &radau : NULL;
}
