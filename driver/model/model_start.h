/** The state that a motion starts from. */
#pragma once

#include "model/model.h"

#include <signal.h>

/** The periodic orbit of a start of kind periodic. docs/orbits.md. */
typedef struct {
    int pitches;          /**< of the first mesh in its period */
    int flows;            /**< of the search */
    int periods;          /**< for which the motion settled */
    int ties;             /**< its events that coincide */
    double time;          /**< its period [s] */
    double residual;      /**< largest difference after a period, in units of the states */
    double multiplier[2]; /**< the largest Floquet multiplier in size, real and imaginary part */
    double time_constant; /**< of the slowest decay [s]; 0: there is none */
    bool has_multiplier, is_stable;
    bool is_reached; /**< the motion from the steady start converges to it */
} model_start_orbit;

typedef enum {
    MODEL_START_FOUND,
    MODEL_START_REFUSED,
    MODEL_START_NOT_FOUND, /**< the search for a periodic orbit failed */
    MODEL_START_INTERRUPTED
} model_start_end;

/** Find the state at t = 0; its arrays belong to the caller, who frees them with dae_state_free. A periodic start keeps its orbit, and
 *  the warnings of it, in the model.
 *  @param interrupt  ends the search for an orbit when it is not 0
 *  @return why there is none with the reason in `error` */
model_start_end model_initial_state(model *model, const volatile sig_atomic_t *interrupt, dae_state *state,
                                    model_message *error);
/** The same without the search for a periodic orbit: then the state is the steady start. @return false with the reason in `error` */
bool model_check_start(const model *model, dae_state *state, model_message *error);
/** The steady start under the loads at t = 0, whatever initial state the description gives. */
bool model_steady_state(const model *model, dae_state *state, model_message *error);
/** The same at a position of the meshes; where the flanks of a mesh are apart in it, because the wheels are too slow to follow their
 *  quasi-static path, the state at this position in which nothing accelerates.
 *  @param mesh_position  pitches of the first mesh in the flow of power; NAN: as the case, or inside a zone */
bool model_state_under_load(const model *model, double mesh_position, dae_state *state, model_message *error);
/** The orbit of the last model_initial_state; NULL if the motion does not start on one. */
const model_start_orbit *model_orbit_of_start(const model *model);
/** The largest multiplier in size; NAN if there is none. */
double model_start_multiplier(const model_start_orbit *orbit);
