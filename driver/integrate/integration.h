/** What every integration has, whatever makes its steps: the output grid, events and their observers. Private to
 *  integrate/, but for integration_is_later. */
#pragma once

#include "integrate/output_grid.h"
#include "integrate/pace.h"

typedef struct {
    memory_pool pool; /**< of the arrays */
    const dae *model;
    const integrate_options *options;
    const integrate_observer *observer;
    dae_state *state; /**< what the caller sees: at the last accepted time */
    integrate_counts *counts;
    char *reason;
    void *stepper;     /**< of dae.stepper, if that makes the steps */
    int *fired;        /**< [n_roots] */
    dae_event *events; /**< [n_events] */
    dae_state trial;   /**< what the model is asked at; its discrete state is not used */
    dae_state old;     /**< state before an event */
    double t_start;
    output_grid grid;
    pace pace; /**< of what happens */
    double
        t_unwatched; /**< where the step began that the observer has not watched yet; the present time if there is none */
    double *lanes;   /**< [n * DAE_LANES] as of dae_stepper.interpolate_lanes */
    double
        t_missed; /**< of the output at which an event was found to be missed; the steps are made anew until past it */
    int times_missed; /**< how often, without coming past it */
    double
        cpu_start; /**< [s] of the thread's time, at which this integration would have begun if it had never been put away */
    double t_rest; /**< latest time at which it could have been kept */
} integration;

/** Processor time of this thread [s]. */
double integration_cpu_now(void);

/** Take memory from its pool. */
void integration_begin(integration *run);

/** The trial state with the discrete state of the present one. */
dae_state integration_borrowed(const integration *run);

/** Whether there is room for a step from t to `later`: times that differ by rounding are the same. */
bool integration_is_later(double later, double t);
/** Of the present time: the smallest step. */
double integration_smallest_step(double t);

/** Hand an output to the observer, if it agrees with the discrete state. *missed: it does not, since an event was passed unseen,
 *  and the step that it lies in is to be made anew.
 *  @param due  NULL: the start or the end */
integrate_code integration_give_output(integration *run, const dae_state *state, const output_due *due, bool *missed);
/** Let the observer watch the present state; of a whole integration it is the first thing seen and the last. */
void integration_watch_state(const integration *run);

/** Apply what happened at the present state, and tell. */
integrate_code integration_apply_event(integration *run, bool time_event);

/** How the steps are made, by `self`. */
typedef struct {
    integrate_code (*advance)(void *self); /**< to the next step, output or event */
    integrate_code (*redo)(void *self);    /**< take the last step back, for a smaller one */
    void (*watch)(void *self);             /**< let the observer look at what it has not seen yet */
    /** before it is kept: be as one that goes on from there will be; NULL: nothing to do */
    integrate_code (*settle)(void *self);
    long (*steps)(const void *self); /**< made so far, of which `advance` makes many; NULL: it makes one */
} integration_ways;
/** Keep all that changes between two steps, its observer's part too. @return false if what was read does not fit, with a reason */
bool integration_keep(integration *run, archive *archive);
/** From the first output, or from where it was kept, to the last. */
integrate_code integration_to_the_end(integration *run, const integration_ways *ways, void *self);

/* To the end, by SUNDIALS IDA or by the stepper that the model brings along. The run's `reason` is empty and its counts are zero. */
integrate_code integrate_by_ida(integration *run);
integrate_code integrate_by_stepper(integration *run);
