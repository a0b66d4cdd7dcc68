/** A resolved case as plain data: what the case file says, defaults filled in. A leaf: knows no other room. */
#pragma once

#include "base/memory.h"

#include <evolvent/description.h>

/** INTEGRATOR_OPEN: the case does not say, and the model has not been asked yet what serves it. */
typedef enum { INTEGRATOR_OPEN, INTEGRATOR_IDA, INTEGRATOR_RADAU } integrator_kind;

/** Below it rounding spoils the step control of radau. */
#define RADAU_SMALLEST_TOLERANCE 1e-13

/** Longest step of IDA in a case that does not say it [s]. */
#define IDA_LONGEST_STEP 0.02

/** Steps of a run in a case that does not say it: ten hours and less. */
#define MOST_STEPS_OF_A_RUN 1e9

/** A window of whole periods: pitches of a mesh, or turns of a wheel if that is not -1. */
typedef struct {
    bool is_given;
    double from, to; /**< [s] */
    int mesh, wheel;
} numbers_description;

/** Outputs by position: where so many times the pitches of a mesh, or the turns of a wheel, are whole. */
typedef struct {
    int number;      /**< 0: outputs go by time */
    int mesh, wheel; /**< one of them is -1 */
} position_description;

typedef struct {
    integrator_kind integrator;
    double duration;
    double accuracy;        /**< of the penetration; 0: the case says a tolerance */
    double tolerance;       /**< 0: it follows from the accuracy, once the integrator is settled */
    double output_interval; /**< [s]; 0 where outputs go by position */
    position_description output_by;
    const char *outputs;         /**< names of variables and groups that a history has; NULL: all */
    double max_step;             /**< [s]; DBL_MAX: none; 0: the case does not say, until the integrator is settled */
    double most_steps;           /**< of a run; DBL_MAX: no limit */
    evl_initial initial;         /**< its arrays belong to it */
    numbers_description numbers; /**< where it is not given, what it would be if it said nothing */
} simulation_description;

/** Texts are the tree's that it was made from, which has to outlive it. */
typedef struct {
    memory_pool pool;  /**< of all arrays */
    const char *title; /**< "" if none */
    int n_wheels, n_meshes, n_shafts, n_accelerometers;
    const char **wheels, **meshes, **shafts, **accelerometers; /**< names */
    simulation_description simulation;
    int n_entries;
    evl_entry *entries; /**< all that the case says */
    double *numbers;    /**< of the entries */
} description;

/** Free what a description holds. */
void description_clear(description *description);
