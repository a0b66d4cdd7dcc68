/** Interface of a model for the integrators: a differential-algebraic system F(t, y, y') = 0 with discrete states, root
 *  functions and events. Independent of the modelled system. */
#pragma once

#include "base/archive.h"
#include "base/memory.h"

#include <stdbool.h>

enum { DAE_MESSAGE_LENGTH = 400 };

/** Number of times at which a stepper interpolates together. */
enum { DAE_LANES = 8 };

/** Largest degree of the dense output of a step, a polynomial in t. */
enum { DAE_DENSE_DEGREE = 7 };

/** Watched channels above this fraction of their largest value so far are exact. */
#define DAE_NEAR 0.98

/** Return codes of the model's procedures. DAE_RECOVERABLE: a trial state outside the model's domain; a smaller step
 *  may help. */
typedef enum { DAE_OK = 0, DAE_RECOVERABLE = 1, DAE_FATAL = -1 } dae_code;

/** All quantities that change during a run. */
typedef struct {
    double t;
    double *y, *yp; /**< [n] */
    int *integers;  /**< [n_integers] */
    double *reals;  /**< [n_reals] */
} dae_state;

/** One occurrence at an event; the model defines the meaning of `subject`, `side` and `count`. */
typedef struct {
    int kind;    /**< index in the model's table of event kinds */
    int subject; /**< part of the model; -1 if none */
    int side;    /**< side of that part; -1 if none */
    int count;   /**< the part's counter after the event; -1 if none */
} dae_event;

/** How a step of a dae_stepper ended. */
typedef enum { DAE_STEPPED, DAE_AT_EVENT, DAE_AT_STOP } dae_outcome;

/** A growing mode of the linearised model. */
typedef struct {
    double t;         /**< time */
    double rate;      /**< real part of its eigenvalue; 0: there is none */
    double frequency; /**< imaginary part, angular, >= 0 */
} dae_growth;

/** Counters of an integration. */
typedef struct {
    long steps, residuals, jacobians, linear_setups, newton_iterations, roots_evaluated, events;
    long error_test_failures, convergence_failures; /**< of IDA; a stepper counts both as rejections */
    long rejections;
    dae_growth growth;  /**< the fastest, if a stepper shortened its steps because of one */
    double cpu_seconds; /**< of the integration with its observers */
} integrate_counts;

/** A time in a step at which a watched channel may exceed its extreme so far. */
typedef struct {
    int channel, sense;    /**< sense: 1 a maximum, -1 a minimum */
    double t, left, right; /**< approximate time, and its bracket */
    double value;          /**< approximate value */
} dae_candidate;

/** Stepper for y' = f(t, y) with event location, optionally provided by a model without algebraic states. Any number of
 *  steppers of one model can be used at once. Procedures that return a dae_code write one sentence to message on
 *  failure. */
typedef struct {
    /** @return a stepper, or NULL with the reason in message */
    void *(*create)(const void *self, double tolerance, double max_step, char message[DAE_MESSAGE_LENGTH]);
    void (*destroy)(void *stepper);
    int (*start)(void *stepper, const dae_state *state, char message[DAE_MESSAGE_LENGTH]);
    /** Make one step from the end of the last one, at most to t_stop (which must be later) and at most to the next
     *  event. Sets t and y of the state; fired: [n_roots] */
    int (*advance)(void *stepper, double t_stop, dae_state *state, int *fired, dae_outcome *outcome,
                   char message[DAE_MESSAGE_LENGTH]);
    /** y at t within the last step. @return true: available */
    bool (*interpolate)(const void *stepper, double t, double *y);
    /** Same for n states only: the others in y are not changed. */
    bool (*interpolate_some)(void *stepper, double t, int n, const int *states, double *y);
    /** The state at DAE_LANES times, at lower cost: y [states * DAE_LANES] for each state variable the values at the
     *  times. */
    void (*interpolate_lanes)(const void *stepper, const double *t, double *y);
    /** Number of candidates for new extremes in the last step, before a restart.
     *  @param high, low  [n_monitored] of each channel so far; infinite if not requested */
    int (*look)(void *stepper, const double *high, const double *low);
    void (*candidate)(const void *stepper, int index, dae_candidate *candidate);
    /** continue from the state after an event */
    void (*restart)(void *stepper, const dae_state *state);
    /** undo the last step: t and y of the state become those of its start, and the next step is smaller */
    void (*redo)(void *stepper, dae_state *state);
    /** counters of its steps; of the growing modes the fastest, if steps were shortened because of one */
    void (*counts)(const void *stepper, integrate_counts *counts);
    /** Serialise all that changes between two steps. A stepper created with the same arguments that reads it instead of
     *  a start continues with bitwise the same results. */
    void (*serialize)(void *stepper, archive *archive);
} dae_stepper;

/** Sparsity pattern of the Jacobian of a model. */
typedef struct {
    /** @return NULL if all entries may be nonzero */
    void *(*create)(const void *self, int *n_entries);
    void (*destroy)(void *pattern);
    /** row and column of each entry, column by column, sorted by row: [n_entries] */
    void (*indices)(const void *pattern, int *rows, int *columns);
    /** as dae.jacobian, only the entries of the pattern: [n_entries] */
    int (*jacobian)(const void *pattern, const dae_state *state, double cj, double *entries,
                    char message[DAE_MESSAGE_LENGTH]);
} dae_pattern;

typedef struct dae {
    const void *self; /**< argument of every procedure; never changed by them */
    int n, n_integers, n_reals, n_roots;
    int n_events;            /**< largest number of occurrences at one event */
    const double *scale;     /**< [n] scale of y[i] for error control */
    const double *row_scale; /**< [n] scale of residual i */

    /* Each returns a dae_code and on failure writes one sentence to message. */
    int (*residual)(const void *self, const dae_state *state, double *residual, char message[DAE_MESSAGE_LENGTH]);
    /** dF/dy + cj dF/dy', column-major [n * n] */
    int (*jacobian)(const void *self, const dae_state *state, double cj, double *jacobian,
                    char message[DAE_MESSAGE_LENGTH]);
    int (*roots)(const void *self, const dae_state *state, double *values, char message[DAE_MESSAGE_LENGTH]);
    void (*root_directions)(const void *self, const int *integers, int *directions);
    double (*next_time_event)(const void *self, const dae_state *state);
    /** events: [n_events] */
    int (*apply_event)(const void *self, dae_state *state, const int *fired, bool time_event, dae_event *events,
                       int *n_events, char message[DAE_MESSAGE_LENGTH]);

    /** Describe an event that repeats endlessly, and `how` this shows; NULL: no descriptions.
     *  @return false: no description of this kind */
    bool (*endless)(const void *self, const dae_event *what, const char *how, char message[DAE_MESSAGE_LENGTH]);

    /** channels that an observer may watch between outputs: [n_monitored] */
    int (*monitored)(const void *self, const dae_state *state, double *values, char message[DAE_MESSAGE_LENGTH]);
    /** Root functions and watched channels together, at little more than the cost of the root functions. A channel of
     *  at most DAE_NEAR of its largest value so far may be an estimate (to a percent) and is positive.
     *  @param highest  [n_monitored] largest value of each channel so far; infinite if not requested
     *  @param cached     [n_cached] workspace with results at earlier positions: zeros initially, and after each change of
     *                  the discrete state */
    int (*roots_and_monitored)(const void *self, const dae_state *state, const double *highest, double *cached,
                               double *roots, double *values, char message[DAE_MESSAGE_LENGTH]);
    int n_monitored, n_cached;
    /** Groups of channels, equal in length, each of which depends on few states. Evaluates one group; the other values
     *  are not changed. */
    int n_groups;
    int (*monitored_of_group)(const void *self, int group, const dae_state *state, double *values,
                              char message[DAE_MESSAGE_LENGTH]);
    /** states: [n] indices of the states that the group needs, in ascending order. @return their number */
    int (*states_of_group)(const void *self, int group, int *states);

    /** Position number `which` at a state, for outputs by position: linear in y while the integers are constant, and
     *  continuous where they change */
    double (*position)(const void *self, int which, const dae_state *state);

    const dae_pattern *pattern; /**< NULL: all entries may be nonzero */
    const dae_stepper *stepper; /**< NULL: the model provides none */
} dae;

/** A state of zeros, in an arena if that is not NULL. */
dae_state dae_state_create(const dae *dae, memory_arena *arena);
/** Copy a state. */
void dae_state_copy(const dae *dae, dae_state *to, const dae_state *from);
/** Free the arrays and set them to NULL. */
void dae_state_free(dae_state *state);
