/** Resolved case as plain data, defaults filled in. Leaf module: no dependencies on other modules. */
#pragma once

#include "base/memory.h"

#include <evolvent/description.h>

/** INTEGRATOR_OPEN: the case does not specify it, and the model has not selected it yet. */
typedef enum { INTEGRATOR_OPEN, INTEGRATOR_IDA, INTEGRATOR_RADAU } integrator_kind;

/** Below it rounding disturbs the step size control of radau. */
#define RADAU_SMALLEST_TOLERANCE 1e-13

/** Default longest step of IDA [s]. */
#define IDA_LONGEST_STEP 0.02

/** Default limit of the number of steps of a run: at most ten hours of computing. */
#define MOST_STEPS_OF_A_RUN 1e9

/** A window of whole periods: pitches of a mesh, or revolutions of a wheel if `wheel` is not -1. */
typedef struct {
    bool is_set;
    double from, to; /**< [s] */
    int mesh, wheel;
} metrics_description;

/** Outputs by position: `number` outputs in each pitch of the mesh, or in each revolution of the wheel. */
typedef struct {
    int number;      /**< 0: outputs by time */
    int mesh, wheel; /**< one of them is -1 */
} position_description;

typedef struct {
    integrator_kind integrator;
    double duration;
    double accuracy;        /**< of the penetration; 0: the case specifies a tolerance */
    double tolerance;       /**< 0: follows from the accuracy, once the integrator is selected */
    double output_interval; /**< [s]; 0 for outputs by position */
    position_description output_by;
    const char *outputs;         /**< names of variables and groups in a history; NULL: all */
    double max_step;             /**< [s]; DBL_MAX: no limit; 0: not specified, until the integrator is selected */
    double most_steps;           /**< of a run; DBL_MAX: no limit */
    evl_initial initial;         /**< owns its arrays */
    metrics_description metrics; /**< if not given: the default window */
} simulation_description;

/** Texts belong to the tree from which it was made; the tree must outlive it. */
typedef struct {
    memory_arena arena; /**< owns all arrays */
    const char *title;  /**< "" if none */
    int n_wheels, n_meshes, n_shafts, n_accelerometers;
    const char **wheels, **meshes, **shafts, **accelerometers; /**< names */
    simulation_description simulation;
    int n_entries;
    evl_entry *entries; /**< all values of the case */
    double *numbers;    /**< of the entries */
} description;

/** Free the contents of a description. */
void description_clear(description *description);
