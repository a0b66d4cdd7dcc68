/** What an integration is asked for, what its caller sees of it, and how it ended. */
#pragma once

#include "integrate/dae.h"

/** A located event: what happened, and the state on both sides of it. */
typedef struct {
    double t;
    dae_event what;
    int n;                           /**< length of the states */
    const dae_state *before, *after; /**< valid during the call only */
} event_record;

typedef struct {
    double t_end;           /**< [s] */
    double output_interval; /**< [s] outputs at start + k * output_interval, and at t_end */
    int per_unit;           /**< > 0: instead where per_unit times a position is whole, and at start and t_end */
    int position_of;        /**< which position, as of dae.position */
    double tolerance;       /**< relative to dae.scale */
    double max_step;        /**< [s]; DBL_MAX: as the errors allow */
    double most_steps;      /**< of the integration, as of pace_spend(); 0: no limit */
    bool by_stepper;        /**< by dae.stepper, which there is, instead of IDA */
} integrate_options;

/** A step, or the part of one up to an event, without a change of the discrete state: the state is known everywhere on it. */
typedef struct {
    double t_from, t_to;    /**< the same: a single state, at the start or the end of an integration */
    bool continues;         /**< the step before ended at t_from, and nothing happened there */
    bool goes_on;           /**< nothing happens at t_to: from there the next step continues, or the integration ends */
    const dae_state *state; /**< at t_to */
    const double
        *watched; /**< the channels there as of dae.roots_and_watched, and then y is of no meaning; else NULL */
    void *with;
    /** y at t in t_from .. t_to. @return false if it is not known after all */
    bool (*interpolate)(const void *with, double t, double *y);
    /** The same of n states alone: the others in y stay as they are. */
    bool (*interpolate_some)(void *with, double t, int n, const int *states, double *y);
    /** as of dae_stepper; NULL: only one at a time */
    void (*interpolate_lanes)(const void *with, const double *t, double *y);
    /** as of dae_stepper; NULL: it knows no candidates */
    int (*look)(void *with, const double *high, const double *low);
    void (*candidate)(const void *with, int index, dae_candidate *candidate);
} integrate_step;

/** How an output by position came about: on the grid forwards, as start or end off the grid, on the grid backwards. A start or end
 *  on the grid counts as forwards. */
typedef enum { OUTPUT_FORWARDS = 0, OUTPUT_OFF_GRID = 1, OUTPUT_BACKWARDS = 2 } output_kind;

typedef struct {
    double position; /**< on the grid exactly what it should be */
    output_kind kind;
} output_mark;

/** An answer to an output: it shows that an event in the step was missed, and the step is made anew, smaller. */
enum { INTEGRATE_ANEW = 2 };

/** What the caller wants to hear; NULL: not that. Each returns 0 to go on; anything else ends the integration with
 *  INTEGRATE_STOPPED. */
typedef struct {
    void *self;
    /** grid points in order of time, the start and t_end among them; may answer INTEGRATE_ANEW, with a sentence in `reason`.
     *  mark: of an output by position; NULL by time */
    int (*output)(void *self, const dae_state *state, const output_mark *mark, char reason[DAE_MESSAGE_LENGTH]);
    /** Of outputs by time the same for several of a stepper's step at once, n at most what `room` says then, and no answer INTEGRATE_ANEW:
     *  who takes them so looks for missed events himself. NULL: one by one.
     *  @param y         [states * DAE_LANES] of each state the times side by side
     *  @param discrete  where the discrete state is taken from */
    int (*several)(void *self, int n, const double *t, const double *y, const dae_state *discrete,
                   char reason[DAE_MESSAGE_LENGTH]);
    int (*room)(const void *self);                        /**< from 1 to DAE_LANES; with `several` */
    int (*change)(void *self);                            /**< before the discrete state changes */
    int (*event)(void *self, const event_record *record); /**< after it was applied */
    int (*step)(void *self, double t);                    /**< now and then, between steps: progress, interrupts */
    /** every step, in order of time: what happens between the outputs; NULL: nobody watches. Always goes on. */
    void (*watch)(void *self, const integrate_step *step);
    /** Between two steps, once at a time: whether the integration is to be kept here, so that it can go on later; NULL: never */
    bool (*is_due)(void *self, double t);
    /** If so: add to the archive, or read from it, what the observer has to know then */
    void (*keep)(void *self, archive *archive);
    /** And then: put it away */
    int (*kept)(void *self, double t, const archive *archive);
    bool
        keeps_spent; /**< it is due, too, where its steps are over, whatever is_due says: with more it goes on from there */
    archive *resume; /**< go on from what was kept; NULL: begin */
    const double
        *highest; /**< of who watches: [n_watched] largest of each channel so far, as of dae.roots_and_watched */
} integrate_observer;

typedef enum {
    INTEGRATE_DONE = 0,
    INTEGRATE_STOPPED = 1,
    INTEGRATE_FAILED = 2,
    INTEGRATE_SPENT = 3 /**< failed as well, but only since its steps are over */
} integrate_code;

/** Of output `index`, 0 at the start; the last one is the end itself. */
double output_grid_time(const integrate_options *options, double t_start, long index);

/** Number of outputs of a whole integration from t_start; 0 if they go by position: it shows at the end. */
long output_grid_size(const integrate_options *options, double t_start);

/** What an output by position at a state would be, whether that is on the grid or not. */
output_mark output_grid_mark(const dae *model, const integrate_options *options, const dae_state *state);
