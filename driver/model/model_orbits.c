#include "model/model_orbits.h"

#include "model/model_kernel.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct model_orbits {
    evl_orbits *orbits;
    model_orbits_setup setup;
    const model *model;               /**< the last model returned by `take` */
    char refusal[DAE_MESSAGE_LENGTH]; /**< reason if `take` failed; "" if not */
};

static int take(void *self, double value, const evl_gearbox **gearbox, const double **scale, evl_status *status)
{
    model_orbits *o = self;
    o->refusal[0] = '\0';
    const model *model = o->setup.take(o->setup.self, value, o->refusal);
    if (model == NULL) {
        *status = (evl_status){.code = EVL_INVALID_INPUT, .index = -1};
        (void)snprintf(status->message, sizeof status->message, "%.300s", o->refusal);
        return status->code;
    }
    o->model = model;
    *gearbox = model->gearbox;
    *scale = model->about.dae.scale;
    return EVL_OK;
}

static int record(void *self, int number, int periods, double *period, double t, double *y, int *integers,
                  double *reals, evl_status *status)
{
    model_orbits *o = self;
    dae_state state = {.t = t, .y = y, .integers = integers, .reals = reals};
    (void)status; /* the reason of a failure is not needed: then the orbit is found in the usual way */
    return o->setup.record(o->setup.self, number - 1, periods, period, &state) ? EVL_OK : EVL_NO_SOLUTION;
}

/** Whether a call succeeded; a message of the caller's own callback is passed on in full. */
static bool check_status(const model_orbits *o, int code, const evl_status *status, char message[DAE_MESSAGE_LENGTH])
{
    if (code != EVL_OK) {
        (void)snprintf(message, DAE_MESSAGE_LENGTH, "%s", o->refusal[0] != '\0' ? o->refusal : status->message);
    }
    return code == EVL_OK;
}

model_orbits *model_orbits_create(const model_orbits_setup *setup, double value, char message[DAE_MESSAGE_LENGTH])
{
    static const double tolerance = 1e-12, residual = 1e-10; /* relative to the scales */
    model_orbits *o = xcalloc(1, sizeof *o);
    o->setup = *setup;
    const evl_orbits_setup to_kernel = {
        .self = o,
        .take = take,
        .record = setup->record != NULL ? record : NULL,
        .from = setup->from,
        .to = setup->to,
        .position = setup->position,
        .tolerance = tolerance,
        .residual = residual,
        .first_step = 0.02,
        .smallest_step = 1e-7,
        .largest_step = 1,
        .straight_step = 8,
        .largest_change = setup->n_values > 0 ? 0.1 : 0.0125, /* without requested values the points must be dense
                                                               * enough for a smooth curve */
        .most_points = 2000,
        .n_values = setup->n_values,
        .values = setup->values,
    };
    evl_status status = {.index = -1};
    o->orbits = evl_orbits_create(&to_kernel, value, &status);
    if (!check_status(o, o->orbits != NULL ? EVL_OK : EVL_INVALID_INPUT, &status, message)) {
        free(o);
        return NULL;
    }
    return o;
}

void model_orbits_delete(model_orbits **orbits)
{
    if (*orbits != NULL) {
        evl_orbits_delete(&(*orbits)->orbits);
        free(*orbits);
        *orbits = NULL;
    }
}

static void from_kernel(const evl_orbit *recorded, model_orbit *orbit)
{
    _Static_assert(MODEL_ORBIT_GRAZING_FOLD - EVL_ORBIT_GRAZING_FOLD == 0, "the kernel's kinds");
    _Static_assert(MODEL_ORBIT_ROOT - EVL_SHORT_LENGTH == 0, "as long as the kernel's");
    *orbit = (model_orbit){.parameter = recorded->parameter,
                           .time = recorded->period,
                           .residual = recorded->residual,
                           .periods = recorded->periods,
                           .kind = recorded->kind,
                           .mesh = recorded->mesh,
                           .iterations = recorded->iterations,
                           .n_multipliers = recorded->n_multipliers,
                           .is_stable = recorded->is_stable,
                           .whole_mesh = recorded->whole_mesh,
                           .recorded = recorded->recorded - 1};
    memcpy(orbit->root, recorded->root, sizeof orbit->root);
}

bool model_orbits_find(model_orbits *orbits, double value, int periods, double time, const dae_state *near,
                       model_orbit *orbit, char message[DAE_MESSAGE_LENGTH])
{
    evl_status status = {.index = -1};
    evl_orbit recorded;
    orbits->refusal[0] = '\0';
    const int code =
        evl_orbits_find(orbits->orbits, value, periods, time, near->y, near->integers, near->reals, &recorded, &status);
    if (code == EVL_OK) {
        from_kernel(&recorded, orbit);
    }
    return check_status(orbits, code, &status, message);
}

bool model_orbits_begin(model_orbits *orbits, bool rising, int *n, char message[DAE_MESSAGE_LENGTH])
{
    evl_status status = {.index = -1};
    orbits->refusal[0] = '\0';
    return check_status(orbits, evl_orbits_begin(orbits->orbits, rising, n, &status), &status, message);
}

bool model_orbits_advance(model_orbits *orbits, int *n, bool *is_over, char message[DAE_MESSAGE_LENGTH])
{
    evl_status status = {.index = -1};
    orbits->refusal[0] = '\0';
    return check_status(orbits, evl_orbits_advance(orbits->orbits, n, is_over, &status), &status, message);
}

model_orbits_progress model_orbits_walk(const model_orbits *orbits)
{
    evl_orbits_progress recorded;
    evl_orbits_walk(orbits->orbits, &recorded);
    return (model_orbits_progress){recorded.step, recorded.crawls, recorded.n_ordinary, recorded.before,
                                   recorded.is_smooth};
}

int model_orbits_record_length(const model_orbits *orbits)
{
    return evl_orbits_record_length(orbits->orbits);
}

void model_orbits_save(const model_orbits *orbits, int branch, int point, double *numbers)
{
    evl_orbits_save(orbits->orbits, branch, point, numbers);
}

void model_orbits_put(model_orbits *orbits, int branch, const double *numbers)
{
    evl_orbits_put(orbits->orbits, branch, numbers);
}

bool model_orbits_go_on(model_orbits *orbits, const model_orbits_progress *progress, char message[DAE_MESSAGE_LENGTH])
{
    evl_status status = {.index = -1};
    const evl_orbits_progress to_kernel = {progress->step, progress->crawls, progress->n_ordinary, progress->before,
                                           progress->is_smooth};
    orbits->refusal[0] = '\0';
    return check_status(orbits, evl_orbits_go_on(orbits->orbits, &to_kernel, &status), &status, message);
}

bool model_orbits_switch(model_orbits *orbits, int branch, int point, char message[DAE_MESSAGE_LENGTH])
{
    static const double distance = 0.02; /* in units of the states */
    evl_status status = {.index = -1};
    orbits->refusal[0] = '\0';
    return check_status(orbits, evl_orbits_switch(orbits->orbits, branch, point, distance, &status), &status, message);
}

void model_orbits_point(const model_orbits *orbits, int branch, int point, model_orbit *orbit, double *multipliers)
{
    evl_orbit recorded;
    evl_orbits_point(orbits->orbits, branch, point, &recorded, multipliers);
    from_kernel(&recorded, orbit);
}

bool model_orbits_state(model_orbits *orbits, int branch, int point, dae_state *state, char message[DAE_MESSAGE_LENGTH])
{
    evl_status status = {.index = -1};
    orbits->refusal[0] = '\0';
    const int code =
        evl_orbits_state(orbits->orbits, branch, point, &state->t, state->y, state->integers, state->reals, &status);
    return check_status(orbits, code, &status, message);
}
