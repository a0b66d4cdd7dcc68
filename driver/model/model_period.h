/** Common period of a gearbox, and states compared by their phase in it. */
#pragma once

#include "integrate/dae.h"
#include "model/model.h"

/** After it all meshes, unequal teeth, harmonic loads and housing motions have the same phase. */
typedef struct {
    int pitches;  /**< of the first mesh */
    int sense;    /**< of a prescribed speed: +1 the nominal sense of rotation, -1 against it */
    bool by_time; /**< with a prescribed speed it is a time; else nothing depends on time, and it is an angle */
    double time;  /**< [s] if by time; else 0 */
} model_period;

/** @return false if there is none, with the obstacle in `error` */
bool model_find_period(const model *model, model_period *period, model_message *error);
/** Shift a state back by whole common periods, counted in the nominal sense of rotation; its time is not changed. */
void model_take_back(const model *model, const model_period *period, int periods, dae_state *state);
/** The largest difference of two states in units of the dae's scales; infinite where the discrete states differ. */
double model_distance(const model *model, const dae_state *a, const dae_state *b);
/** Convert a state of another model, with other parameters, to one of this model at a time.
 *  @param other  the other model's dae
 *  @param to     of this model
 *  @return false with the reason in `message` */
bool model_take_over(const model *model, const dae *other, const dae_state *from, double t, dae_state *to,
                     char message[DAE_MESSAGE_LENGTH]);
