/** What an integrator has to know of a model: a differential-algebraic system F(t, y, y') = 0 with discrete states, roots and events.
 *  Nothing here knows what is being modelled. */
#pragma once

#include "base/archive.h"
#include "base/memory.h"

#include <stdbool.h>

enum { DAE_MESSAGE_LENGTH = 400 };

/** How many times a stepper interpolates at once. */
enum { DAE_LANES = 8 };

/** The dense output of a step is a polynomial in t of this degree at most. */
enum { DAE_DENSE_DEGREE = 7 };

/** Watched channels above this part of their largest so far are exact. */
#define DAE_NEAR 0.98

/** Answers of the model's procedures. DAE_RECOVERABLE: a trial state outside the model's domain; a smaller step may help. */
typedef enum { DAE_OK = 0, DAE_RECOVERABLE = 1, DAE_FATAL = -1 } dae_code;

/** All that changes during a run. */
typedef struct {
    double t;
    double *y, *yp; /**< [n] */
    int *integers;  /**< [n_integers] */
    double *reals;  /**< [n_reals] */
} dae_state;

/** One thing that happened at an event; `subject`, `side` and `count` mean something to the model only. */
typedef struct {
    int kind;    /**< index in the model's table of event kinds */
    int subject; /**< which part of the model; -1 if none */
    int side;    /**< which side of that part; -1 if none */
    int count;   /**< the part's counter after the event; -1 if none */
} dae_event;

/** How a step of a dae_stepper ended. */
typedef enum { DAE_STEPPED, DAE_AT_EVENT, DAE_AT_STOP } dae_outcome;

/** A mode of the linearised model that grows. */
typedef struct {
    double t;         /**< when */
    double rate;      /**< real part of its eigenvalue; 0: there is none */
    double frequency; /**< imaginary part, angular, >= 0 */
} dae_growth;

/** What an integration cost. */
typedef struct {
    long steps, residuals, jacobians, linear_setups, newton_iterations, roots_evaluated, events;
    long error_test_failures, convergence_failures; /**< of IDA; a stepper counts both as rejections */
    long rejections;
    dae_growth growth;  /**< the fastest, if a stepper made shorter steps for one */
    double cpu_seconds; /**< of the integration with its observers */
} integrate_counts;

/** A place in a step where a watched channel may exceed the extreme so far. */
typedef struct {
    int channel, sense;    /**< sense: 1 a maximum, -1 a minimum */
    double t, left, right; /**< about where, and between which times */
    double value;          /**< about what */
} dae_candidate;

/** Steps of y' = f(t, y) with located events, which a model without algebraic states may bring along: any number of steppers of
 *  one model may be at work. Where a dae_code is returned, a failure leaves one sentence in message. */
typedef struct {
    /** @return a stepper, or NULL with the reason in message */
    void *(*create)(const void *self, double tolerance, double max_step, char message[DAE_MESSAGE_LENGTH]);
    void (*destroy)(void *stepper);
    int (*start)(void *stepper, const dae_state *state, char message[DAE_MESSAGE_LENGTH]);
    /** One step from where the last one ended, at most to t_stop, which lies behind, and at most to the next event. Sets t and y
     *  of the state; fired: [n_roots] */
    int (*advance)(void *stepper, double t_stop, dae_state *state, int *fired, dae_outcome *outcome,
                   char message[DAE_MESSAGE_LENGTH]);
    /** y at t within the last step. @return true: it is known */
    bool (*interpolate)(const void *stepper, double t, double *y);
    /** The same of n states alone: the others in y stay as they are. */
    bool (*interpolate_some)(void *stepper, double t, int n, const int *states, double *y);
    /** The state at DAE_LANES times, which is cheaper: y [states * DAE_LANES] of each state the times side by side. */
    void (*interpolate_lanes)(const void *stepper, const double *t, double *y);
    /** How many candidates for new extremes the last step has, before a restart.
     *  @param high, low  [n_watched] of each channel so far; infinite where nobody asks */
    int (*look)(void *stepper, const double *high, const double *low);
    void (*candidate)(const void *stepper, int index, dae_candidate *candidate);
    /** go on from the state that an event left */
    void (*restart)(void *stepper, const dae_state *state);
    /** take the last step back and go on from its start, which t and y of the state become, in smaller steps */
    void (*redo)(void *stepper, dae_state *state);
    /** what its steps cost; of the modes that grow the one that did so fastest, if steps were made shorter for one */
    void (*counts)(const void *stepper, integrate_counts *counts);
    /** Keep all that changes between two steps: a stepper that was created alike and reads it instead of a start goes on with the same
     *  bits. */
    void (*keep)(void *stepper, archive *archive);
} dae_stepper;

/** The Jacobian of a model by the entries that may differ from zero. */
typedef struct {
    /** @return NULL if all may */
    void *(*create)(const void *self, int *n_entries);
    void (*destroy)(void *pattern);
    /** row and column of each entry, column after column and in each by rows: [n_entries] */
    void (*places)(const void *pattern, int *rows, int *columns);
    /** as dae.jacobian, the entries alone: [n_entries] */
    int (*jacobian)(const void *pattern, const dae_state *state, double cj, double *entries,
                    char message[DAE_MESSAGE_LENGTH]);
} dae_pattern;

typedef struct dae {
    const void *self; /**< handed to every procedure; never changed by them */
    int n, n_integers, n_reals, n_roots;
    int n_events;            /**< the most that can happen at one event */
    const double *scale;     /**< [n] unit in which an error of y[i] counts */
    const double *row_scale; /**< [n] unit of residual i */

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

    /** Say of an event that it happens without end, and how that shows; NULL: nothing to say.
     *  @return false: nothing to say of this kind */
    bool (*endless)(const void *self, const dae_event *what, const char *how, char message[DAE_MESSAGE_LENGTH]);

    /** channels that an observer may watch between outputs: [n_watched] */
    int (*watched)(const void *self, const dae_state *state, double *values, char message[DAE_MESSAGE_LENGTH]);
    /** Roots and watched at once, which costs little more than the roots: a channel that is at most DAE_NEAR of its largest so far
     *  may be an estimate, to a percent, and is positive.
     *  @param highest  [n_watched] largest of each channel so far; infinite where nobody asks
     *  @param kept     [n_kept] room for what is known of places before: zeros at first, and after each change of the
     *                  discrete state */
    int (*roots_and_watched)(const void *self, const dae_state *state, const double *highest, double *kept,
                             double *roots, double *values, char message[DAE_MESSAGE_LENGTH]);
    int n_watched, n_kept;
    /** The channels come in groups of one length, each of which depends on few states. This finds those of one group, the other
     *  values stay. */
    int n_groups;
    int (*watched_of_group)(const void *self, int group, const dae_state *state, double *values,
                            char message[DAE_MESSAGE_LENGTH]);
    /** states: [n] the states that it needs, in their order. @return how many */
    int (*states_of_group)(const void *self, int group, int *states);

    /** Position `which` at a state, by which outputs may go: linear in y while the integers stay, and without a jump where they
     *  change */
    double (*position)(const void *self, int which, const dae_state *state);

    const dae_pattern *pattern; /**< NULL: all entries may differ from zero */
    const dae_stepper *stepper; /**< NULL: it brings none along */
} dae;

/** A state of zeros, in a pool if that is not NULL. */
dae_state dae_state_create(const dae *dae, memory_pool *pool);
/** Make a state that of another. */
void dae_state_copy(const dae *dae, dae_state *to, const dae_state *from);
/** Free the arrays, and make them NULL. */
void dae_state_free(dae_state *state);
