/** Types of a model: its outputs, messages, names and constant data. */
#pragma once

#include "integrate/dae.h"

/** One variable of the history: constant over time (is_static), or one value or array of values per time. */
typedef struct {
    const char *name, *units, *symbol, *long_name; /**< valid as long as the program */
    const char *dims; /**< names of the dimensions besides time: "", "wheel", "mesh axis" and so on */
    bool is_static, is_integer;
    int offset, count;   /**< position in the array filled by model_outputs; count 0: the case has no such variable */
    const char *rate_of; /**< output whose rate it is, as in evl_output; NULL: none */
} model_output;

/** Reason of a refusal, or a warning; with the location in the case file. */
typedef struct {
    char field[192]; /**< path in the case, "" for the case as a whole */
    char message[DAE_MESSAGE_LENGTH];
} model_message;

/** Default field of messages about a start. */
#define MODEL_START "simulation.initial"

typedef struct model model;

typedef struct {
    int n;
    const char *const *names; /**< [n] */
} name_list;

/** Names of the elements to which the values of a model belong. */
typedef struct {
    name_list wheels, meshes, shafts, accelerometers;
    name_list pairs; /**< tooth pairs of a mesh in the outputs: drive_0, drive_1, ..., coast_0, ... */
} model_names;

/** Constant data of a model. */
typedef struct {
    dae dae; /**< its stepper is the kernel's integrator radau, if that supports the model */
    model_names names;
    int n_outputs, n_values;     /**< n_values: number of values of all outputs at a state */
    const model_output *outputs; /**< [n_outputs] */
} model_facts;

/** Periodic orbit of a start of kind periodic. docs/theory/orbits.md. */
typedef struct {
    int pitches;          /**< of the first mesh in its period; 0: the motion does not start on an orbit */
    int flows;            /**< number of integrations in the search */
    int periods;          /**< number of periods of the settling motion */
    int ties;             /**< number of coincident events */
    double time;          /**< its period [s] */
    double residual;      /**< largest difference after a period, in units of the states */
    double multiplier[2]; /**< the Floquet multiplier of largest magnitude, real and imaginary part */
    double time_constant; /**< of the slowest decay [s]; 0: there is none */
    bool has_multiplier, is_stable;
    bool is_reached; /**< the motion from the steady start converges to it */
} model_start_orbit;
