#include "model/model_start.h"

#include "base/memory.h"
#include "model/model_kernel.h"

#include <math.h>
#include <stdio.h>

enum { MOST_FLOWS = 200 }; /* of a search; docs/theory/orbits.md */

static void refuse(const model *model, const evl_status *status, dae_state *state, model_message *error)
{
    model_explain_start(model, status, error);
    dae_state_free(state);
}

static bool start(const model *model, const evl_initial *initial, dae_state *state, model_message *error)
{
    *state = dae_state_create(&model->about.dae, NULL);
    evl_status status = {.index = -1};
    const int code = evl_gearbox_initial_state(model->gearbox, initial, state->t, state->y, state->yp, state->integers,
                                               state->reals, &status);
    if (code != EVL_OK) {
        refuse(model, &status, state, error);
    }
    return code == EVL_OK;
}

static bool is_over(void *interrupt)
{
    const volatile sig_atomic_t *number = interrupt;
    return *number != 0;
}

static model_start_orbit orbit_of(const evl_periodic *found)
{
    return (model_start_orbit){.pitches = found->pitches,
                               .flows = found->flows,
                               .periods = found->periods,
                               .ties = found->ties,
                               .time = found->time,
                               .residual = found->residual,
                               .multiplier = {found->multiplier[0], found->multiplier[1]},
                               .time_constant = found->time_constant,
                               .has_multiplier = found->has_multiplier,
                               .is_stable = found->is_stable,
                               .is_reached = found->is_reached};
}

static model_start_end start_periodic(const model *model, const volatile sig_atomic_t *interrupt, dae_state *state,
                                      model_start_orbit *orbit, model_message *error)
{
    const evl_periodic_setup setup = {
        .self = (void *)interrupt, .is_over = interrupt != NULL ? is_over : NULL, .most_flows = MOST_FLOWS};
    *state = dae_state_create(&model->about.dae, NULL);
    evl_status status = {.index = -1};
    evl_periodic found;
    const int code = evl_gearbox_periodic_start(model->gearbox, &model->initial, &setup, &found, state->y, state->yp,
                                                state->integers, state->reals, &status);
    if (code == EVL_OK) {
        *orbit = orbit_of(&found);
        return MODEL_START_FOUND;
    }
    refuse(model, &status, state, error);
    return found.is_interrupted                              ? MODEL_START_INTERRUPTED
           : found.has_searched && code != EVL_INVALID_INPUT ? MODEL_START_NOT_FOUND
                                                             : MODEL_START_REFUSED;
}

model_start_end model_initial_state(const model *model, const volatile sig_atomic_t *interrupt, dae_state *state,
                                    model_start_orbit *orbit, model_message *error)
{
    *orbit = (model_start_orbit){0};
    if (model->initial.kind == EVL_INITIAL_PERIODIC) {
        return start_periodic(model, interrupt, state, orbit, error);
    }
    return start(model, &model->initial, state, error) ? MODEL_START_FOUND : MODEL_START_REFUSED;
}

bool model_check_start(const model *model, dae_state *state, model_message *error)
{
    if (model->initial.kind != EVL_INITIAL_PERIODIC) {
        return start(model, &model->initial, state, error);
    }
    *state = dae_state_create(&model->about.dae, NULL);
    evl_status status = {.index = -1};
    evl_periodic found;
    const int code = evl_gearbox_periodic_check(model->gearbox, &model->initial, &found, state->y, state->yp,
                                                state->integers, state->reals, &status);
    if (code != EVL_OK) {
        refuse(model, &status, state, error);
    }
    return code == EVL_OK;
}

/** State of the kind at a position; NaN: at the position of the case, if it gives one. */
static bool find_at(const model *model, evl_initial_kind kind, double mesh_position, dae_state *state,
                    model_message *error)
{
    const bool as_the_case = isnan(mesh_position) &&
                             (model->initial.kind == EVL_INITIAL_STEADY || model->initial.kind == EVL_INITIAL_PERIODIC);
    const evl_initial steady = {.kind = kind,
                                .mesh_position = as_the_case ? model->initial.mesh_position : mesh_position};
    return start(model, &steady, state, error);
}

bool model_steady_state(const model *model, dae_state *state, model_message *error)
{
    return find_at(model, EVL_INITIAL_STEADY, NAN, state, error);
}

/** Whether the flanks of any mesh are separated. */
static bool is_apart(const model *model, const dae_state *state)
{
    char message[DAE_MESSAGE_LENGTH];
    const int first = model_output_offset(model, "pairs_in_contact");
    bool apart = false;
    CLEANUP_FREE double *values = xcalloc((size_t)model->sizes.n_values, sizeof *values);
    if (model_outputs(model, state, values, message) == DAE_OK) {
        for (int i = 0; i < model->sizes.n_meshes; i++) {
            apart = apart || values[first + i] <= 0;
        }
    }
    return apart;
}

bool model_state_under_load(const model *model, double mesh_position, dae_state *state, model_message *error)
{
    if (!find_at(model, EVL_INITIAL_STEADY, mesh_position, state, error)) {
        return false;
    }
    if (!is_apart(model, state)) {
        return true;
    }
    dae_state_free(state);
    return find_at(model, EVL_INITIAL_EQUILIBRIUM, mesh_position, state, error);
}

double model_start_multiplier(const model_start_orbit *orbit)
{
    return orbit->has_multiplier ? hypot(orbit->multiplier[0], orbit->multiplier[1]) : NAN;
}

bool model_start_warning(const model_start_orbit *orbit, model_message *warning)
{
    if (orbit->pitches == 0 || (orbit->is_stable && orbit->is_reached)) {
        return false;
    }
    (void)snprintf(warning->field, sizeof warning->field, "%s.kind", MODEL_START);
    const double size = model_start_multiplier(orbit), border = 1 + 1e-6; /* accuracy of a multiplier */
    if (!orbit->is_stable && size > border) {
        (void)snprintf(warning->message, sizeof warning->message,
                       "the periodic orbit is unstable, the magnitude of its largest Floquet multiplier is %.4g, so "
                       "the motion leaves it; kind: steady with a longer duration leads to a stable motion",
                       size);
    } else if (!orbit->is_stable) {
        (void)snprintf(warning->message, sizeof warning->message,
                       "disturbances of the periodic orbit do not decay, the magnitude of its largest Floquet "
                       "multiplier is 1; add damping to its undamped components");
    } else {
        (void)snprintf(warning->message, sizeof warning->message,
                       "the motion from the steady start did not approach the periodic orbit within %d common periods, "
                       "and may lead to another motion; check with kind: steady and a longer duration",
                       orbit->periods);
    }
    return true;
}
