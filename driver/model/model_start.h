/** Initial state of a motion. */
#pragma once

#include "model/model.h"

#include <signal.h>

typedef enum {
    MODEL_START_FOUND,
    MODEL_START_REFUSED,
    MODEL_START_NOT_FOUND, /**< the search for a periodic orbit failed */
    MODEL_START_INTERRUPTED
} model_start_end;

/** Find the state at t = 0; its arrays belong to the caller, who frees them with dae_state_free.
 *  @param interrupt    ends the search for an orbit when it is not 0
 *  @param[out] orbit   of a periodic start
 *  @return how it ended, with the reason in `error` */
model_start_end model_initial_state(const model *model, const volatile sig_atomic_t *interrupt, dae_state *state,
                                    model_start_orbit *orbit, model_message *error);
/** Same without the search for a periodic orbit: then the state is the steady start. @return false with the reason in
 *  `error` */
bool model_check_start(const model *model, dae_state *state, model_message *error);
/** The steady start under the loads at t = 0, for any initial state of the description. */
bool model_steady_state(const model *model, dae_state *state, model_message *error);
/** Same at a position of the meshes. If flanks separate in it, because the wheels are too slow to follow their
 *  quasi-static path: the state at this position without accelerations.
 *  @param mesh_position  pitches of the first mesh in the power flow; NAN: as in the case, or inside a zone */
bool model_state_under_load(const model *model, double mesh_position, dae_state *state, model_message *error);
/** The multiplier of largest magnitude; NAN if there is none. */
double model_start_multiplier(const model_start_orbit *orbit);
/** Write the warning of an orbit: it is unstable, or the motion does not converge to it. @return whether there is one */
bool model_start_warning(const model_start_orbit *orbit, model_message *warning);
