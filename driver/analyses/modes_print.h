/** Output of `evolvent modes`. */
#pragma once

#include "model/model_modes.h"
#include "simulate/case_plan.h"

#include <stdio.h>

/** Linearisation point. */
typedef enum {
    MODES_STEADY, /**< a steady state under load */
    MODES_MEAN,   /**< the steady states at all positions of the meshes, with the mean of the matrices */
    MODES_AT      /**< the state of the motion at a time */
} modes_kind;

typedef struct {
    const case_plan *plan;
    dae_state state; /**< linearisation point; for MODES_MEAN one of the states */
    double *values;  /**< [model_n_values] the outputs there, or their means */
    modes_kind kind;
    double
        mesh_position; /**< of MODES_STEADY: pitches of the first mesh from the start of contact; NAN: not requested */
    model_start_orbit start; /**< of the motion, for MODES_AT */
    natural_modes modes;
} modes_report;

/** Print tables. */
void modes_print_text(FILE *stream, const modes_report *report);
/** Print one JSON object in SI units and in full precision, for scripts. */
void modes_print_json(FILE *stream, const modes_report *report);
