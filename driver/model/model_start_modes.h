/** Distance of a start from the steady motion, mode by mode. */
#pragma once

#include "base/memory.h"
#include "model/model.h"

/** A mode, standing for its conjugate too. */
typedef struct {
    double rate;      /**< at which it decays [1/s]; negative: it grows */
    double frequency; /**< angular [rad/s]; 0: it does not oscillate */
    double *left;     /**< [n_values] its amplitude at the start in each output, linearised */
} start_mode;

typedef struct {
    memory_pool pool;
    int n;
    start_mode *modes;
} start_modes;

/** @return false with the reason in `error`; then there is nothing to free */
bool model_start_modes(const model *model, const dae_state *start, start_modes *modes, model_message *error);
