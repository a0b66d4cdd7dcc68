/** Common part of all integrations: output grid, events and their observers. Private to integrate/. */
#pragma once

#include "integrate/output_grid.h"
#include "integrate/progress_rate.h"

typedef struct {
    memory_arena arena; /**< owns the arrays */
    const dae *model;
    const integrate_options *options;
    const integrate_observer *observer;
    dae_state *state; /**< the caller's state, at the last accepted time */
    integrate_counts *counts;
    char *reason;
    void *stepper;     /**< of dae.stepper, if used */
    int *fired;        /**< [n_roots] */
    dae_event *events; /**< [n_events] */
    dae_state trial;   /**< argument of model evaluations; its discrete state is not used */
    dae_state old;     /**< state before an event */
    double t_start;
    output_grid grid;
    progress_rate progress_rate; /**< progress monitor */
    double
        t_unmonitored; /**< start of the step that the observer has not processed yet; the present time if there is none */
    double *lanes;     /**< [n * DAE_LANES] as in dae_stepper.interpolate_lanes */
    double
        t_missed; /**< time of the output at which a missed event was detected; steps are repeated until they pass it */
    int times_missed; /**< number of attempts without passing it */
    double cpu_start; /**< [s] of the thread's CPU time: start of the integration without interruptions */
    double t_rest;    /**< latest time at which a checkpoint was possible */
} integration;

/** CPU time of this thread [s]. */
double integration_cpu_now(void);

/** Allocate memory from its arena. */
void integration_begin(integration *run);

/** The trial state with the discrete state of the present one. */
dae_state integration_borrowed(const integration *run);

/** Pass an output to the observer, if it agrees with the discrete state. *missed: it does not, since an event was
 *  missed; the step must be repeated.
 *  @param due  NULL: the start or the end */
integrate_code integration_give_output(integration *run, const dae_state *state, const output_due *due, bool *missed);
/** Let the observer process the present state; the first and last call of a whole integration. */
void integration_monitor_state(const integration *run);

/** Apply the events at the present state, and notify the observer. */
integrate_code integration_apply_event(integration *run, bool time_event);

/** Methods of a stepping scheme, called with `self`. */
typedef struct {
    integrate_code (*advance)(void *self); /**< to the next step, output or event */
    integrate_code (*redo)(void *self);    /**< undo the last step, for a smaller one */
    void (*monitor)(void *self);           /**< let the observer process the steps that it has not seen */
    /** before a checkpoint: bring the scheme into the state that a resumed run has; NULL: not required */
    integrate_code (*settle)(void *self);
    long (*steps)(const void *self); /**< steps so far, if `advance` makes several; NULL: it makes one */
} integration_scheme;
/** Serialise all that changes between two steps, including the observer's part. @return false if the data read do not
 *  match, with a reason */
bool integration_serialize(integration *run, archive *archive);
/** Integrate from the first output, or from a checkpoint, to the last output. */
integrate_code integration_to_the_end(integration *run, const integration_scheme *scheme, void *self);

/* Integrate to the end by SUNDIALS IDA or by the model's stepper. On entry the run's `reason` is empty and its counters
 * are zero. */
integrate_code integrate_by_ida(integration *run);
integrate_code integrate_by_stepper(integration *run);
