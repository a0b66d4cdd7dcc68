/** Distance of a start from the steady motion, mode by mode. */
#pragma once

#include "base/memory.h"
#include "model/model.h"

/** A mode, or a conjugate pair. */
typedef struct {
    double rate;      /**< decay rate [1/s]; negative: it grows */
    double frequency; /**< angular [rad/s]; 0: not oscillatory */
    double *left;     /**< [n_values] linearised amplitude at the start in each output */
} start_mode;

typedef struct {
    memory_arena arena;
    int n;
    start_mode *modes;
} start_modes;

/** @return false with the reason in `error`; then there is nothing to free */
bool model_start_modes(const model *model, const dae_state *start, start_modes *modes, model_message *error);
