/** Options, observers and return codes of an integration. */
#pragma once

#include "integrate/dae.h"

/** A located event: its kind, and the states before and after it. */
typedef struct {
    double t;
    dae_event what;
    int n;                           /**< length of the states */
    const dae_state *before, *after; /**< valid only during the call */
} event_record;

typedef struct {
    double t_end;           /**< [s] */
    double output_interval; /**< [s] outputs at start + k * output_interval, and at t_end */
    int per_unit;      /**< > 0: outputs at multiples of 1/per_unit of a position instead, and at start and t_end */
    int position_of;   /**< index of the position, as in dae.position */
    double tolerance;  /**< relative to dae.scale */
    double max_step;   /**< [s]; DBL_MAX: limited by the error control only */
    double most_steps; /**< step limit of the integration, as in progress_rate_spend(); 0: no limit */
    bool by_stepper;   /**< use dae.stepper, which must exist, instead of IDA */
} integrate_options;

/** A step, or the part of one up to an event, with a constant discrete state: the state is available everywhere on it. */
typedef struct {
    double t_from, t_to;    /**< if equal: a single state, at the start or the end of an integration */
    bool continues;         /**< the previous step ended at t_from, without an event there */
    bool goes_on;           /**< no event at t_to: the next step continues from there, or the integration ends */
    const dae_state *state; /**< at t_to */
    const double
        *monitored; /**< channels there as from dae.roots_and_monitored, in which case y is undefined; else NULL */
    void *with;
    /** y at t in t_from .. t_to. @return false if it is not available */
    bool (*interpolate)(const void *with, double t, double *y);
    /** Same for n states only: the others in y are not changed. */
    bool (*interpolate_some)(void *with, double t, int n, const int *states, double *y);
    /** as in dae_stepper; NULL: not available */
    void (*interpolate_lanes)(const void *with, const double *t, double *y);
    /** as in dae_stepper; NULL: no candidates available */
    int (*look)(void *with, const double *high, const double *low);
    void (*candidate)(const void *with, int index, dae_candidate *candidate);
} integrate_step;

/** Kind of an output by position: on the grid forwards, start or end off the grid, on the grid backwards. A start or
 *  end on the grid counts as forwards. */
typedef enum { OUTPUT_FORWARDS = 0, OUTPUT_OFF_GRID = 1, OUTPUT_BACKWARDS = 2 } output_kind;

typedef struct {
    double position; /**< on the grid its exact value */
    output_kind kind;
} output_mark;

/** Return code for an output: an event in the step was missed, and the step is repeated with a smaller size. */
enum { INTEGRATE_ANEW = 2 };

/** Callbacks of the caller; NULL: not called. Each returns 0 to continue; any other value ends the integration with
 *  INTEGRATE_STOPPED. */
typedef struct {
    void *self;
    /** grid points in order of time, including the start and t_end; may return INTEGRATE_ANEW with a sentence in
     *  `reason`. mark: of an output by position; NULL by time */
    int (*output)(void *self, const dae_state *state, const output_mark *mark, char reason[DAE_MESSAGE_LENGTH]);
    /** Same for several outputs by time in one step of a stepper, n at most the present value of `capacity`. INTEGRATE_ANEW
     *  is not allowed: the observer must detect missed events itself. NULL: one by one.
     *  @param y         [states * DAE_LANES] for each state variable the values at the times
     *  @param discrete  has the discrete state */
    int (*several)(void *self, int n, const double *t, const double *y, const dae_state *discrete,
                   char reason[DAE_MESSAGE_LENGTH]);
    int (*capacity)(const void *self);                    /**< from 1 to DAE_LANES; required with `several` */
    int (*change)(void *self);                            /**< before the discrete state changes */
    int (*event)(void *self, const event_record *record); /**< after it was applied */
    int (*step)(void *self, double t); /**< called occasionally between steps: progress, interrupts */
    /** every step in order of time, including the motion between outputs; NULL: not called. Cannot end the integration. */
    void (*monitor)(void *self, const integrate_step *step);
    /** Between two steps, once for each time: whether to write a checkpoint here; NULL: never */
    bool (*is_due)(void *self, double t);
    /** For a checkpoint: write the observer's state to the archive, or read it */
    void (*serialize)(void *self, archive *archive);
    /** Then: store the checkpoint */
    int (*write_checkpoint)(void *self, double t, const archive *archive);
    bool
        checkpoint_at_limit; /**< checkpoint also at the step limit, regardless of is_due, to resume with a larger limit */
    archive *resume;         /**< checkpoint to resume from; NULL: start */
    const double *
        highest; /**< for `monitor`: [n_monitored] largest value of each channel so far, as in dae.roots_and_monitored */
} integrate_observer;

typedef enum {
    INTEGRATE_DONE = 0,
    INTEGRATE_STOPPED = 1,
    INTEGRATE_FAILED = 2,
    INTEGRATE_SPENT = 3 /**< failed because of the step limit only */
} integrate_code;

/** The same integration without outputs between t and another end. */
integrate_options integrate_options_between(const integrate_options *options, double t, double t_end);

/** Time of output `index`, 0 at the start; the last one is the end. */
double output_grid_time(const integrate_options *options, double t_start, long index);

/** Number of outputs of a whole integration from t_start; 0 for outputs by position, whose number is not known in
 *  advance. */
long output_grid_size(const integrate_options *options, double t_start);

/** Mark of an output by position at a state, whether on the grid or not. */
output_mark output_grid_mark(const dae *model, const integrate_options *options, const dae_state *state);
