/** evolvent kernel: the mechanics of spur gearboxes, in one C interface.
 *
 *  A gearbox is made once by evl_gearbox_create and never changes after that, but for inputs that its owner gives anew (evl_gearbox_feed). Everything that does change is a state, held by the
 *  caller in plain arrays whose lengths evl_gearbox_sizes tells:
 *
 *    y, yp     [n_states]    continuous state and its time derivative, SI units
 *    integers  [n_integers]  discrete state: turns of the reference wheel, teeth passed, contact and friction modes, table segments
 *    reals     [n_reals]     discrete state: approach speed at the last closing of each mesh
 *
 *  Each call is a function of (gearbox, state) alone: it prints nothing, keeps nothing, and may run in any number of threads on the
 *  same gearbox. Every fallible call returns an evl_code and, where it fails and `status` is not NULL, fills it with one sentence
 *  that names the symbol, its value and its unit.
 *
 *  SI units and radians throughout; angles, angular velocities and torques are counterclockwise positive. */
#ifndef EVOLVENT_KERNEL_H
#define EVOLVENT_KERNEL_H

#include <evolvent/description.h>

#include <stdbool.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#if defined(__GNUC__)
#define EVL_API __attribute__((visibility("default")))
#else
#define EVL_API
#endif

/** What a call can answer. EVL_OUT_OF_DOMAIN is recoverable: a trial state outside the model's domain, a smaller step may help. */
typedef enum {
    EVL_OK = 0,
    EVL_INVALID_INPUT = 1, /**< a parameter is refused; subject, index and field say which */
    EVL_OUT_OF_DOMAIN = 2, /**< the state leaves the domain of a law, such as limit (15) of the Johnson force */
    EVL_SINGULAR = 3,      /**< a linear system has no solution at this state */
    EVL_NO_SOLUTION = 4,   /**< no steady state exists, or it was not found */
    EVL_NO_MEMORY = 5,
    EVL_STORE_FAILED = 6 /**< the caller's evl_wheel_store says so */
} evl_code;

typedef enum {
    EVL_SUBJECT_NONE = 0,
    EVL_SUBJECT_WHEEL = 1,
    EVL_SUBJECT_MESH = 2,
    EVL_SUBJECT_LOAD = 3,
    EVL_SUBJECT_INITIAL = 4,
    EVL_SUBJECT_HOUSING = 5,
    EVL_SUBJECT_SHAFT = 6
} evl_subject;

enum { EVL_FIELD_LENGTH = 48, EVL_MESSAGE_LENGTH = 320, EVL_MAX_PARAMETERS = 8 };

typedef struct {
    int code;                         /**< evl_code */
    int subject;                      /**< evl_subject: what the message is about */
    int index;                        /**< which wheel, mesh, load or shaft, from 0; -1 if none */
    char field[EVL_FIELD_LENGTH];     /**< key of the offending parameter in the block of the subject; "" if none */
    char message[EVL_MESSAGE_LENGTH]; /**< one sentence without a final newline; "" if there is nothing to say */
} evl_status;

/* ---- description of a gearbox ---------------------------------------------------------------------------------------------- */

/** The table of all rows, the same for every case; those of a block stand together, the one that selects its variant first.
 *  @return how many there are; of them `most` are written */
EVL_API int evl_rows(int most, evl_row *rows);
/** The kinds of a block that has them: contact, damping, friction, load, support. Those of "event" are what happens in a motion, by
 *  the number that evl_event has. @return as above */
EVL_API int evl_kinds(const char *block, int most, evl_kind *kinds);

typedef struct evl_description evl_description;

/** Make a description of entries, which are copied: every number in its range, every block complete. Keys with a default may stay
 *  away, and so may what the kernel does not read, such as the duration. @return NULL with the reason in `status` */
EVL_API evl_description *evl_description_create(int n, const evl_entry *entries, evl_status *status);
/** Make another description of one that is not needed any more, cheaply: the entries are the same but for their numbers, which
 *  are checked where they have changed. @return false if they are not, or one is refused; then the description can only be deleted,
 *  and evl_description_create says why */
EVL_API bool evl_description_renew(evl_description *description, int n, const evl_entry *entries);
/** Free a description and set the pointer to NULL. Nothing happens if it is NULL already. */
EVL_API void evl_description_delete(evl_description **description);
/** Where in the case is what a status is about: a path as in --set, as far as the case says it; "" if it is the case as a whole. */
EVL_API void evl_description_path(const evl_description *description, const evl_status *status,
                                  char path[EVL_PATH_LENGTH]);

/** Parameter `index` (from 0) of a description, in its order, and of its n numbers `most`. @return whether there is one */
EVL_API bool evl_description_parameter(const evl_description *description, int index, evl_parameter *parameter,
                                       int most, double *numbers);
/** Give it others [n]; gearboxes that were made before stay as they are. @return EVL_OK, or EVL_INVALID_INPUT: it keeps its own */
EVL_API int evl_description_set(evl_description *description, int index, const double *numbers, evl_status *status);

/* ---- gearbox --------------------------------------------------------------------------------------------------------------- */

typedef struct evl_gearbox evl_gearbox;

/** Make a gearbox: resolve radii and centres, derive all geometry. All wheels have to be connected by meshes and shafts.
 *  @param store  of the wheels that give way, asked only here; NULL: each different wheel is computed
 *  @return the gearbox, which no longer needs the description, or NULL with the reason in `status` */
EVL_API evl_gearbox *evl_gearbox_create(const evl_description *description, const evl_wheel_store *store,
                                        evl_status *status);
/** Free a gearbox and set the pointer to NULL. Nothing happens if it is NULL already. */
EVL_API void evl_gearbox_delete(evl_gearbox **gearbox);

typedef struct {
    int n_wheels, n_meshes, n_loads, n_states, n_integers, n_reals, n_roots, n_outputs, n_values, n_warnings;
    int n_pair_places;  /**< places that the outputs have for the tooth pairs of a mesh */
    int n_drive_places; /**< how many of them are for the drive flank; they come first */
    int n_shafts;
    int n_events; /**< the most that can happen at one event */
    int n_kept;   /**< length of `kept` of evl_gearbox_roots_and_watched */
} evl_sizes;

EVL_API void evl_gearbox_sizes(const evl_gearbox *gearbox, evl_sizes *sizes);

/** Warning `index` (from 0) of the creation: something allowed, but worth knowing. As an error it says what it is about by
 *  subject, index and field; its code is EVL_OK. With `initial`, which may be NULL, one more may follow, of speeds above 1e5 rad/s of
 *  the loads or the start. @return whether there is one */
EVL_API bool evl_gearbox_warning(const evl_gearbox *gearbox, const evl_initial *initial, int index,
                                 evl_status *warning);

/** The geometry that follows from the description, of a wheel or a mesh as evl_of says. quantities: [EVL_MOST_QUANTITIES].
 *  @return how many there are, 0 where it is not what they are of */
EVL_API int evl_gearbox_geometry(const evl_gearbox *gearbox, int of, int index, evl_output *quantities);
/** The same of a description from which no gearbox can be made: EVL_OF_GEAR of the gears that exist and EVL_OF_GEAR_MESH of their
 *  meshes, also where they cannot mesh; 0 quantities of all else. */
EVL_API int evl_description_geometry(const evl_description *description, int of, int index, evl_output *quantities);
/** Cumulative position deviations of a wheel's teeth: `most` of them are written, arcs on the reference circle [m].
 *  @return how many there are, one a tooth; 0 if it has no pitch errors */
EVL_API int evl_gearbox_pitch_errors(const evl_gearbox *gearbox, int wheel, int most, double *errors);
/** Directions in which the support of a wheel lets its axle move: unit vectors (x, y) one after the other. @return how many, 0 to 2 */
EVL_API int evl_gearbox_support_directions(const evl_gearbox *gearbox, int wheel, double directions[4]);

/** Parameters of the damping law of a mesh in the order of its rows, with what the case left open filled in. */
EVL_API void evl_gearbox_damping(const evl_gearbox *gearbox, int mesh, double parameters[EVL_MAX_PARAMETERS]);
/** Fill y, yp, integers and reals for time t. @return EVL_OK, EVL_INVALID_INPUT (initial values that contradict each other or the
 *  loads), EVL_NO_SOLUTION (steady state), EVL_OUT_OF_DOMAIN. */
EVL_API int evl_gearbox_initial_state(const evl_gearbox *gearbox, const evl_initial *initial, double t, double *y,
                                      double *yp, int *integers, double *reals, evl_status *status);

/** Scales for error control, absolute, from the loads and the initial state: state[i] is the unit in which an error of y[i] counts, row[i] the unit
 *  of residual i.
 *  @param duration  of the run [s]: what loads bring in within it is measured by it */
EVL_API void evl_gearbox_scales(const evl_gearbox *gearbox, const evl_initial *initial, double duration, double *state,
                                double *row);

/** The name of state `index` with its wheel or mesh, such as "angle_deviation_1", and its unit. Wheels that rigid shafts join share
 *  one deviation, named after the first of them. */
EVL_API void evl_gearbox_state_name(const evl_gearbox *gearbox, int index, char name[EVL_SHORT_LENGTH],
                                    char units[EVL_SHORT_LENGTH]);

/** F(t, y, y') = 0, row i in its own unit. Allocates nothing. @return EVL_OK or EVL_OUT_OF_DOMAIN. */
EVL_API int evl_gearbox_residual(const evl_gearbox *gearbox, double t, const double *y, const double *yp,
                                 const int *integers, const double *reals, double *residual, evl_status *status);
/** dF/dy + cj dF/dy', column-major [n_states * n_states], analytic. */
EVL_API int evl_gearbox_jacobian(const evl_gearbox *gearbox, double t, double cj, const double *y, const double *yp,
                                 const int *integers, const double *reals, double *jacobian, evl_status *status);
/** The Jacobian by the entries that may differ from zero in some state; of a gearbox, which has to outlive it. */
typedef struct evl_pattern evl_pattern;
/** @return NULL if all may: in a mounted housing */
EVL_API evl_pattern *evl_pattern_create(const evl_gearbox *gearbox, int *n_entries);
/** Makes *pattern NULL. */
EVL_API void evl_pattern_delete(evl_pattern **pattern);
/** Row and column of each entry, from 0, column after column and in each by rows: [n_entries] */
EVL_API void evl_pattern_places(const evl_pattern *pattern, int *rows, int *columns);
/** As evl_gearbox_jacobian, the entries alone: [n_entries] */
EVL_API int evl_pattern_jacobian(const evl_pattern *pattern, double t, double cj, const double *y, const double *yp,
                                 const int *integers, const double *reals, double *values, evl_status *status);
/** The y' that belongs to y: the explicit right-hand side; for tracked meshes the linear system of the differential form is
 *  solved with LAPACK, so algebraic states get their true derivative as well. */
EVL_API int evl_gearbox_derivative(const evl_gearbox *gearbox, double t, const double *y, const int *integers,
                                   const double *reals, double *yp, evl_status *status);

/* ---- events ---------------------------------------------------------------------------------------------------------------- */

typedef struct {
    int kind;       /**< place in the table of event kinds, from 0 */
    int mesh;       /**< -1 if it concerns no mesh */
    int tooth_pair; /**< pitches since the start, after the event; -1 if it concerns no mesh */
    int flank;      /**< evl_flank; -1 if it concerns no mesh */
} evl_event;

typedef enum {
    EVL_FLANK_DRIVE = 0, /**< the driving wheel pushes in its nominal sense of rotation */
    EVL_FLANK_COAST = 1  /**< the other side of the teeth */
} evl_flank;

/** Root functions [n_roots], each scaled to be of order 1; those that have no meaning in the present mode are 1. */
EVL_API int evl_gearbox_roots(const evl_gearbox *gearbox, const double *y, const int *integers, const double *reals,
                              double *values, evl_status *status);
/** Directions [n_roots] that count in the present mode: +1 rising, -1 falling, 0 without a meaning. To be asked again after each event. */
EVL_API void evl_gearbox_root_directions(const evl_gearbox *gearbox, const int *integers, int *directions);
/** Time of the next knot of a table; +infinity if there is none. */
EVL_API double evl_gearbox_next_time_event(const evl_gearbox *gearbox, const int *integers);
/** Apply what happened at t: `fired` [n_roots] as IDAGetRootInfo gives it (0, +1, -1), `time_event` if t is that of
 *  evl_gearbox_next_time_event. Changes y, integers, reals and fills yp consistently. events: [n_events].
 *  @return EVL_OK; the number of events in *n_events. */
EVL_API int evl_gearbox_apply_event(const evl_gearbox *gearbox, double t, const int *fired, bool time_event, double *y,
                                    double *yp, int *integers, double *reals, evl_event *events, int *n_events,
                                    evl_status *status);

/* ---- inputs ---------------------------------------------------------------------------------------------------------------- */

/** A load that is one number, which its caller may give anew while the gearbox moves: a constant torque, or a prescribed speed without
 *  a table. */
typedef struct {
    int load;      /**< for evl_gearbox_feed */
    int wheel;     /**< on which it acts */
    int place;     /**< among the loads of that wheel, from 0 */
    bool is_speed; /**< a speed, else a torque */
    double value;  /**< now [N m] or [rad/s] */
} evl_input;

/** Input `index` (from 0) of a gearbox, wheel after wheel. @return whether there is one */
EVL_API bool evl_gearbox_input(const evl_gearbox *gearbox, int index, evl_input *input);
/** Give an input anew, the one thing of a gearbox that changes: whoever does so has the gearbox to himself, and an integration of it
 *  goes on by evl_radau_restart.
 *  @param value  torque [N m], or the speed [rad/s], which counts where a motion starts: later the wheel turns as it does
 *  @param rate   of a speed [rad/s^2], as which the wheel turns on; 0 for a torque */
EVL_API void evl_gearbox_feed(evl_gearbox *gearbox, int load, double value, double rate);
/** Angular velocity of a wheel [rad/s], against the ground, or in the housing if a prescribed speed of it refers to that. */
EVL_API double evl_gearbox_wheel_speed(const evl_gearbox *gearbox, int wheel, double t, const double *y);

/* ---- integration ----------------------------------------------------------------------------------------------------------- */

/** An integration of a gearbox in closed form, y' = f(t, y), by Radau IIA of order 13 with located events. It holds all that
 *  changes: any number of them may run at once, also of one gearbox, which has to outlive them. */
typedef struct evl_radau evl_radau;

/** What a call of evl_radau_advance came to. */
typedef enum {
    EVL_RADAU_STEP = 0,  /**< a step */
    EVL_RADAU_EVENT = 1, /**< a step that ends where root functions pass zero */
    EVL_RADAU_STOP = 2   /**< a step that ends at t_stop */
} evl_radau_outcome;

/** What it cost since evl_radau_start. */
typedef struct {
    int steps;            /**< accepted */
    int rejections;       /**< steps repeated for their error, or because the iteration failed */
    int evaluations;      /**< of f, those of the seven stages counted one by one */
    int iterations;       /**< of Newton's method */
    int jacobians;        /**< evaluated */
    int factorisations;   /**< of the systems of all stages at once */
    int root_evaluations; /**< of the root functions beyond once a step */
    /* of all modes that grow the one that did so fastest, if steps were cut for one: docs/radau.md */
    double growth_t;         /**< when [s] */
    double growth_rate;      /**< at which it grows, the real part of its eigenvalue [1/s]; 0: there is none */
    double growth_frequency; /**< imaginary part [rad/s], >= 0 */
} evl_radau_counts;

/** Whether it can be integrated so. @return EVL_OK, or EVL_INVALID_INPUT with what stands in the way: a rigid contact,
 *  tracked contact points, a mounted housing. */
EVL_API int evl_radau_serves(const evl_gearbox *gearbox, evl_status *status);

/** @param scale      [n_states] units in which errors count, as from evl_gearbox_scales; those of the reference angle and
 *                    speed are tightened
 *  @param tolerance  error of a step in these units, 1e-13 to 0.1
 *  @param max_step   longest step [s] > 0
 *  @return NULL with EVL_INVALID_INPUT or EVL_NO_MEMORY in status */
EVL_API evl_radau *evl_radau_create(const evl_gearbox *gearbox, const double *scale, double tolerance, double max_step,
                                    evl_status *status);
/** Accepts NULL and a pointer to NULL; sets *radau to NULL. */
EVL_API void evl_radau_delete(evl_radau **radau);

/** Begin at (t, y) with counts of 0. @return EVL_OK or EVL_OUT_OF_DOMAIN. */
EVL_API int evl_radau_start(evl_radau *radau, double t, const double *y, const int *integers, const double *reals,
                            evl_status *status);
/** Make one step, at most to t_stop > t and at most to the next event, from where the last one ended. Allocates nothing.
 *  @param[out] t, y     where it ended
 *  @param[out] fired    [n_roots] +1 risen through zero, -1 fallen, 0 nothing
 *  @param[out] outcome  evl_radau_outcome
 *  @return EVL_OK, EVL_OUT_OF_DOMAIN (the model has no answer for any step), EVL_NO_SOLUTION (the step became too small) */
EVL_API int evl_radau_advance(evl_radau *radau, double t_stop, double *t, double *y, int *fired, int *outcome,
                              evl_status *status);
/** State at t within the last step. */
EVL_API void evl_radau_interpolate(const evl_radau *radau, double t, double *y);
/** The same of n states alone; the others stay as they are. */
EVL_API void evl_radau_interpolate_some(const evl_radau *radau, double t, int n, const int *states, double *y);
/** The same at EVL_LANES times: y [n_states * EVL_LANES], of each state the times side by side. */
EVL_API void evl_radau_interpolate_lanes(const evl_radau *radau, const double *t, double *y);
/** Go on after an event from (t, y) with the discrete state that evl_gearbox_apply_event left. */
EVL_API void evl_radau_restart(evl_radau *radau, double t, const double *y, const int *integers, const double *reals);
/** Take the last step back: go on from its start (t, y), which are set, in smaller ones. */
EVL_API void evl_radau_redo(evl_radau *radau, double *t, double *y);
EVL_API void evl_radau_get_counts(const evl_radau *radau, evl_radau_counts *counts);

/** What evl_radau_keep does. */
typedef enum {
    EVL_KEEP_MEASURE = 0, /**< nothing but count */
    EVL_KEEP_WRITE = 1,   /**< put all that changes in an integration into words */
    EVL_KEEP_READ = 2 /**< take it from there, into one created for the same gearbox, scales, tolerance and max_step */
} evl_keep;
/** Keep an integration between two calls of evl_radau_advance: one that reads it goes on with the same bits, also in another process
 *  with the same kernel. An integration that reads need not have been started.
 *  @param words  [n] of the kernel's own meaning; NULL to measure
 *  @return the words that it takes; -1 if they are not n, or of another gearbox: then it is to be deleted */
EVL_API int64_t evl_radau_keep(evl_radau *radau, int direction, int64_t n, int64_t *words);
/** A place in a step where a channel may exceed the extreme so far. */
typedef struct {
    int channel;        /**< as of evl_gearbox_watched */
    int sense;          /**< 1 a maximum, -1 a minimum */
    double t;           /**< [s] */
    double left, right; /**< it lies between these [s] */
    double value;       /**< about that of the channel there */
} evl_candidate;
/** Look for new extremes in the step that evl_radau_advance made, before evl_radau_restart. Allocates nothing.
 *  @param high, low  extremes of each channel so far; +infinity and -infinity if nobody asks
 *  @return how many candidates there are: most often none */
EVL_API int evl_radau_look(evl_radau *radau, const double *high, const double *low);
/** One of them; index: from 0. */
EVL_API void evl_radau_candidate(const evl_radau *radau, int index, evl_candidate *candidate);

/* ---- outputs --------------------------------------------------------------------------------------------------------------- */

/** The tables of outputs, the same for all gearboxes. */
typedef enum {
    EVL_TABLE_OF_STATE = 0,   /**< n_outputs of every gearbox */
    EVL_TABLE_OF_STATIC = 1,  /**< of the static analysis; static ones do not depend on the torque */
    EVL_TABLE_OF_EXTREMES = 2 /**< of a mesh, or of its tooth pairs, whose extreme is told over the run */
} evl_table_of;

/** A table. @return how many rows it has; of them `most` are written */
EVL_API int evl_table(int of, int most, evl_output *outputs);
/** Where the outputs of a gearbox stand in the array that evl_gearbox_outputs fills, in C order; [n_outputs] each. A count of 0:
 *  it is not there, as the pose of a fixed housing. */
EVL_API void evl_gearbox_output_places(const evl_gearbox *gearbox, int *offsets, int *counts);
/** The outputs that never change, where they stand among all [n_values]; 0 where others stand. */
EVL_API void evl_gearbox_constants(const evl_gearbox *gearbox, double *values);
/** All outputs at a state, [n_values]; integers as whole doubles, NaN where a quantity has no meaning. With `check` the discrete
 *  state has to agree with y: every tooth pair pushes, overlaps or is apart as its modes say, to 1e-6 of the reference force and
 *  penetration. @return EVL_OK; EVL_OUT_OF_DOMAIN also if it does not: an event was missed, which smaller steps may find */
EVL_API int evl_gearbox_outputs(const evl_gearbox *gearbox, double t, const double *y, const int *integers,
                                const double *reals, bool check, double *values, evl_status *status);

/** How many states the kernel takes at once. */
enum { EVL_LANES = 8 };

/** Asks for some outputs at many states; belongs to one thread. */
typedef struct evl_sampler evl_sampler;

/** @param wanted  [n] places in the table, from 0. The gearbox has to outlive it */
EVL_API evl_sampler *evl_sampler_create(const evl_gearbox *gearbox, int n, const int *wanted);
/** Whether eight states are told at once: else they are asked one by one. */
EVL_API bool evl_sampler_in_lanes(const evl_sampler *sampler);
EVL_API void evl_sampler_delete(evl_sampler **sampler);
/** At n states of one discrete state, as in a step; eight at once are quickest, and tell what one tells, to the bit. Nothing
 *  is found that only other outputs need.
 *  @param n_meant the first of them count; the others are any states that have an answer, as the last one once more
 *  @param check   as of evl_gearbox_outputs
 *  @param t       [n]
 *  @param y       [n_states * n] of each state the n values side by side
 *  @param values  one wanted output behind the other, as many values each as evl_gearbox_output_places counts; of each the n states side
 *                 by side. @return as evl_gearbox_outputs */
EVL_API int evl_sampler_ask(evl_sampler *sampler, int n, int n_meant, const double *t, const double *y,
                            const int *integers, const double *reals, bool check, double *values, evl_status *status);

/* ---- extremes -------------------------------------------------------------------------------------------------------------- */

/** All channels at a state [n_watched * n_meshes], n_watched being the number of different `watched` in the table of extremes. Each of
 *  these outputs is a channel of each mesh: channel n_watched * mesh + watched. An output of tooth pairs is there with the largest of
 *  its pairs. @return EVL_OK or EVL_OUT_OF_DOMAIN */
EVL_API int evl_gearbox_watched(const evl_gearbox *gearbox, const double *y, const int *integers, const double *reals,
                                double *values, evl_status *status);
/** The channels of one mesh, as evl_gearbox_watched finds them; the other values stay, and of y only the mesh's states are looked at. */
EVL_API int evl_gearbox_watched_mesh(const evl_gearbox *gearbox, int mesh, const double *y, const int *integers,
                                     const double *reals, double *values, evl_status *status);
/** The states on which the contacts of a mesh depend, in their order: [n_states] at most. @return how many */
EVL_API int evl_gearbox_mesh_states(const evl_gearbox *gearbox, int mesh, int *states);
/** What evl_gearbox_roots and evl_gearbox_watched give, for little more than the first alone: the pressure of flanks that deviate
 *  from involutes may be an estimate where that is at most near * highest, to half a percent.
 *  @param highest  largest so far of each channel; infinite where nobody asks, -infinite where all are to be exact
 *  @param kept     [n_kept] what was found before of flanks: zeros at first and after each change of the discrete
 *                  state. It is the caller's */
EVL_API int evl_gearbox_roots_and_watched(const evl_gearbox *gearbox, const double *y, const int *integers,
                                          const double *reals, double near, const double *highest, double *kept,
                                          double *roots, double *values, evl_status *status);

/* ---- outputs by position ----------------------------------------------------------------------------------------------------- */

/** The driving wheel of a mesh. */
EVL_API int evl_gearbox_driving_wheel(const evl_gearbox *gearbox, int mesh);
/** Whether anything turns a wheel, or may: a wheel that moves at the start [n_states], a load, the housing. */
EVL_API bool evl_gearbox_can_turn(const evl_gearbox *gearbox, int wheel, const double *y, const double *yp);
/** Pitches of the driving wheel of a mesh from where its tooth pair 0, unloaded, is at the start of contact, the position of the
 *  static analysis; growing in the nominal sense of that wheel. Linear in y while the integers stay. */
EVL_API double evl_gearbox_pitches(const evl_gearbox *gearbox, int mesh, const double *y, const int *integers);
/** Turns of a wheel since its start position, growing in its nominal sense; likewise linear. */
EVL_API double evl_gearbox_turns(const evl_gearbox *gearbox, int wheel, const double *y, const int *integers);

/* ---- common period ------------------------------------------------------------------------------------------------------------ */

/** After it all meshes, teeth that differ, harmonic loads and motions of the housing are where they were. */
typedef struct {
    int pitches;  /**< of the first mesh */
    int sense;    /**< of a prescribed speed: +1 the nominal sense of rotation, -1 against it */
    bool by_time; /**< a speed is prescribed: it is a time; else nothing goes by time, and it is an angle */
    double time;  /**< [s] if by time; else 0 */
} evl_period;
/** @return EVL_OK, or EVL_INVALID_INPUT where there is none, with what stands in the way */
EVL_API int evl_gearbox_period(const evl_gearbox *gearbox, evl_period *period, evl_status *status);
/** Take a state back by whole common periods, counted in the nominal sense of rotation: angles, tooth pairs and their slots become those
 *  of the same place before; the energies begin anew. */
EVL_API void evl_gearbox_take_back(const evl_gearbox *gearbox, const evl_period *period, int periods, double *y,
                                   int *integers, double *reals);
/** How far two states are from each other: the largest difference of a state in its unit scale[i], of an approach speed in that of its
 *  contact; infinite where the discrete states differ. Energies do not count. */
EVL_API double evl_gearbox_distance(const evl_gearbox *gearbox, const double *scale, const double *y_a,
                                    const int *integers_a, const double *reals_a, const double *y_b,
                                    const int *integers_b, const double *reals_b);
/** Make a state of a like gearbox, with other parameters, one of this gearbox: speeds that are prescribed become those of its loads, all
 *  wheels turning with them; penetrations stay; tooth pairs are where its teeth meet, in the modes that belong to that.
 *  @param alike  the other one has as many integers and reals: approach speeds live on; else only the first integer counts
 *  @return EVL_OK, or EVL_OUT_OF_DOMAIN if a law has no answer there */
EVL_API int evl_gearbox_take_over(const evl_gearbox *gearbox, bool alike, double t, double *y, double *yp,
                                  int *integers, double *reals, evl_status *status);

/* ---- orbits ------------------------------------------------------------------------------------------------------------------- */

/** Periodic orbits of gearboxes that differ in one number, the parameter: found by shooting, followed in it. docs/orbits.md. */
typedef struct evl_orbits evl_orbits;
/** The gearbox with a value of the parameter and the scales of its states [n_states], which live until the next call.
 *  @return EVL_OK, or why there is none: any other code, with the reason in `status` */
typedef int evl_orbits_take(void *self, double value, const evl_gearbox **gearbox, const double **scale,
                            evl_status *status);
/** Follow the last gearbox that was taken once round, from a state on the section, for what is to be told of an orbit: that run says at
 *  the same time whether it is one.
 *  @param number  from 1, of a point that this call of evl_orbits_advance may add; what was told under it before is not wanted any more
 *  @param period  how long that is [s]; where no speed is prescribed it becomes what it took
 *  @param y, integers, reals  become the state at the end, as one of the period where it began
 *  @return EVL_OK, or any other code if it does not come round */
typedef int evl_orbits_tell(void *self, int number, int periods, double *period, double t, double *y, int *integers,
                            double *reals, evl_status *status);
typedef struct {
    void *self; /**< for `take` and `tell` */
    evl_orbits_take *take;
    evl_orbits_tell *tell; /**< for orbits at `values`; NULL: they are found as others are */
    double from, to;       /**< the parameter stays between these; their distance counts as 1 along a branch */
    double
        place; /**< of the section, where a speed is prescribed: pitches of the first mesh after t = 0; away from events */
    double tolerance;                               /**< of the integration, in units of the scales */
    double residual;                                /**< largest difference after a period, in units of the scales */
    double first_step, smallest_step, largest_step; /**< along a branch, states in units of their scales */
    double straight_step;  /**< the largest where the branch does not turn, if that is larger */
    double largest_change; /**< of the parameter in a step, over the range */
    int most_points;       /**< of a branch; special ones, and those at `values`, not counted */
    int n_values;
    const double
        *values; /**< [n_values] of the parameter, rising or falling, at which each branch has its stable orbits too */
} evl_orbits_setup;
/** What a point of a branch is. */
typedef enum {
    EVL_ORBIT_ORDINARY,
    EVL_ORBIT_FOLD,
    EVL_ORBIT_CROSSING, /**< another branch crosses */
    EVL_ORBIT_DOUBLING,
    EVL_ORBIT_NEIMARK_SACKER,
    EVL_ORBIT_TOUCH, /**< a root function just touches zero (grazing): flanks just part. Multipliers depend on the side */
    EVL_ORBIT_TOUCH_FOLD /**< the same, and the branch turns back there */
} evl_orbit_kind;
typedef struct {
    double parameter;
    double period;   /**< until it repeats [s] */
    double residual; /**< in units of the scales */
    int periods;     /**< common periods until it repeats */
    int kind;        /**< evl_orbit_kind */
    int mesh;        /**< of a touch; else -1 */
    int iterations;  /**< of Newton that it took */
    int n_multipliers;
    int told; /**< the number under which `tell` followed it: it is stable as its neighbours are, and has no multipliers; 0: none */
    bool is_stable;              /**< all multipliers are smaller than 1 */
    bool whole_mesh;             /**< of a touch: no tooth pair of the mesh carries then; false: others do */
    char root[EVL_SHORT_LENGTH]; /**< of a touch: which root function; else "" */
} evl_orbit;
/** @param value  a first value, whose gearbox gives the scales
 *  @return NULL on failure: EVL_INVALID_INPUT where there is no common period, or radau does not integrate it; what `take` said */
EVL_API evl_orbits *evl_orbits_create(const evl_orbits_setup *setup, double value, evl_status *status);
/** Delete; sets *orbits to NULL. */
EVL_API void evl_orbits_delete(evl_orbits **orbits);
/** Newton's iteration from a state near an orbit: it becomes the present one.
 *  @param periods  common periods until it repeats
 *  @param period   about how long that is where no speed is prescribed [s]; else not used
 *  @return EVL_OK; EVL_NO_SOLUTION, EVL_SINGULAR if none was found */
EVL_API int evl_orbits_find(evl_orbits *orbits, double value, int periods, double period, const double *y,
                            const int *integers, const double *reals, evl_orbit *orbit, evl_status *status);
/** Stand at the first point of the branch of the present orbit: a new branch, the next number from 0.
 *  @param n  its points: 1, on failure 0 */
EVL_API int evl_orbits_begin(evl_orbits *orbits, bool rising, int *n, evl_status *status);
/** Go on to the next point of the last branch. @param n  its points, with special ones before it, also on failure @param is_over  it
 *  has no more */
EVL_API int evl_orbits_advance(evl_orbits *orbits, int *n, bool *is_over, evl_status *status);
/** How far the last branch was followed: what its next point depends on beside its points. */
typedef struct {
    double step;
    int crawls, n_ordinary;
    int before;    /**< which of its points, from 1, is the ordinary one before the last; 0: none */
    int is_smooth; /**< the cubic through its last two points told the last step better than the tangent */
} evl_orbits_progress;
EVL_API void evl_orbits_walk(const evl_orbits *orbits, evl_orbits_progress *progress);
/** How many numbers are to be kept of a point, so that another process finds the same points behind it. */
EVL_API int evl_orbits_kept(const evl_orbits *orbits);
EVL_API void evl_orbits_keep(const evl_orbits *orbits, int branch, int point, double *numbers);
/** Put down what was kept of the next point of a branch, or of the first of the next branch. @param numbers  NULL: that has no point */
EVL_API void evl_orbits_put(evl_orbits *orbits, int branch, const double *numbers);
/** Stand at the last point of the last branch, all of whose points were put down. */
EVL_API int evl_orbits_go_on(evl_orbits *orbits, const evl_orbits_progress *progress, evl_status *status);
/** From a doubling to the branch of twice the period: its first orbit becomes the present one, and leads away from there. */
EVL_API int evl_orbits_switch(evl_orbits *orbits, int branch, int point, double distance, evl_status *status);
/** @param multipliers  [n_multipliers][2] at most one a state and a tooth contact: real and imaginary part, by falling size */
EVL_API void evl_orbits_point(const evl_orbits *orbits, int branch, int point, evl_orbit *orbit, double *multipliers);
/** The state on the section of a point, or of the present orbit if `branch` is negative. */
EVL_API int evl_orbits_state(evl_orbits *orbits, int branch, int point, double *t, double *y, int *integers,
                             double *reals, evl_status *status);

/* ---- the periodic start ------------------------------------------------------------------------------------------------------ */

/** Whether a search ends before its next flow. */
typedef bool evl_periodic_is_over(void *self);
/** Search setup. */
typedef struct {
    void *self;
    evl_periodic_is_over *is_over; /**< NULL: it is not interrupted */
    int most_flows;                /**< integrations over the common period or a part of it, >= 1 */
} evl_periodic_setup;
/** The periodic orbit of a start. */
typedef struct {
    int pitches;     /**< of the first mesh in the common period; 0: there is none */
    int flows;       /**< of the search */
    int periods;     /**< common periods for which the motion settled */
    int ties;        /**< events of the orbit that coincide: the multipliers are those of one order of these events */
    double time;     /**< period [s] */
    double residual; /**< largest difference after a period, in units of the scales */
    double multiplier[2]; /**< the largest Floquet multiplier in size, real and imaginary part; 0: below 1e-10 */
    double time_constant; /**< of the slowest decay [s]; 0: there is none */
    bool has_multiplier;  /**< `multiplier` is known */
    bool is_stable;       /**< all multipliers are smaller than 1 in size */
    bool is_reached;      /**< the motion from the steady start converges to the orbit */
    bool is_interrupted;
    bool has_searched; /**< the case was not refused before the first flow */
} evl_periodic;
/** Find the periodic orbit that the motion from the steady start leads to, and fill y, yp, integers and reals with its state at
 *  t = 0, at the mesh position of the steady start. docs/orbits.md.
 *  @return EVL_OK; EVL_INVALID_INPUT (no periodic start is possible, or the search needs more flows), EVL_NO_SOLUTION (no steady
 *          state, no orbit was found, or the search was interrupted), EVL_OUT_OF_DOMAIN */
EVL_API int evl_gearbox_periodic_start(const evl_gearbox *gearbox, const evl_initial *initial,
                                       const evl_periodic_setup *setup, evl_periodic *found, double *y, double *yp,
                                       int *integers, double *reals, evl_status *status);
/** The same without the search: y, yp, integers and reals become the steady start. `pitches`, `time` are found. */
EVL_API int evl_gearbox_periodic_check(const evl_gearbox *gearbox, const evl_initial *initial, evl_periodic *found,
                                       double *y, double *yp, int *integers, double *reals, evl_status *status);

/* ---- natural modes --------------------------------------------------------------------------------------------------------- */

/** Discrete state of the tooth pair that has been longest on the path of a mesh's drive flank. */
EVL_API void evl_gearbox_mesh_mode(const evl_gearbox *gearbox, int mesh, const double *y, const int *integers,
                                   const double *reals, evl_mesh_mode *mode);

/** Linearise the gearbox at a state: eigenvalues and eigenvectors of small motions x' = A x, from slow to fast.
 *
 *  x: speed of the reference wheel; deviation and its rate of every other rotor; displacements and velocities of the supports.
 *  Speeds that are prescribed do not take part. The angle of the driving wheel
 *  of the first mesh in the flow of power, contact modes and friction branches are held.
 *
 *  @param[out] n_modes      number of eigenvalues, at most n_states
 *  @param[out] n_rigid      number of independent motions that nothing restores; turning as a whole (theta) is one of them unless
 *                           a speed is prescribed, though theta has no eigenvalue here
 *  @param[out] eigenvalues  [2 * n_states] real and imaginary part [1/s] by turns, as C's double complex; the partner of a complex
 *                           one stands beside it, positive imaginary part first; 0 if rounding leaves nothing else
 *  @param[out] vectors      [2 * n_states * n_states] mode after mode, each a change of y, of any size; theta is omega/lambda
 *  @param[out] means  [n_values] NULL; or else it is the mean of A over the steady states at all positions of the meshes: 997, spread
 *                      evenly over the least number of pitches of the first mesh, at most 10000, in which every mesh passes whole
 *                      pitches. Then outputs, averaged in the same way, and y, integers, reals become the steady state half a pitch
 *                      from the start of contact, to which the vectors belong
 *  @param n_positions  positions over which that mean is taken; 0: 997. A smaller number should be a prime that does not divide the
 *                      number of pitches
 *  @return EVL_OK, EVL_OUT_OF_DOMAIN (the state is not one of the model's, or forces have no derivative there), EVL_NO_SOLUTION
 *          (LAPACK found no eigenvalues); of the mean also what evl_gearbox_initial_state returns where there is no steady state */
EVL_API int evl_gearbox_modes(const evl_gearbox *gearbox, double t, double *y, int *integers, double *reals,
                              int *n_modes, int *n_rigid, double *eigenvalues, double *vectors, double *means,
                              int n_positions, evl_status *status);

/** What a small change dy of the state y moves, to first order and so linear in dy.
 *  @param[out] arcs                 [n_wheels] r_b phi, r phi of a wheel without a mesh, counterclockwise [m]
 *  @param[out] displacements        [n_wheels][2] of the axles, x and y [m]
 *  @param[out] penetrations         [n_meshes] h [m]
 *  @param[out] transmission_errors  [n_meshes] Delta [m] */
EVL_API void evl_gearbox_shape(const evl_gearbox *gearbox, const double *y, const double *dy, double *arcs,
                               double *displacements, double *penetrations, double *transmission_errors);

/** Distance of a start from the steady motion: start - motion = the sum of Re amplitude_k vector_k over all modes k, which decay as
 *  exp(eigenvalue_k t). The modes are those of the mean of A over one pitch of the first mesh; the steady motion is the linear response
 *  to the static path over this pitch. Modes of eigenvalue 0 have the amplitude 0.
 *  @param start, start_integers  the start
 *  @param[out] y, integers, reals  a steady state half a pitch from the start, at which outputs may be linearised
 *  @param[out] n_modes, eigenvalues  as of evl_gearbox_modes
 *  @param[out] vectors     [2 * n_states * n_states] as of evl_gearbox_modes; the largest entry of each is the scale of its state, theta
 *                          takes no part
 *  @param[out] amplitudes  [2 * n_states]
 *  @return as evl_gearbox_modes of a mean */
EVL_API int evl_gearbox_start_distance(const evl_gearbox *gearbox, double t, const double *start,
                                       const int *start_integers, double *y, int *integers, double *reals, int *n_modes,
                                       double *eigenvalues, double *vectors, double *amplitudes, evl_status *status);

/* ---- static analysis ------------------------------------------------------------------------------------------------------- */

/** What the static analysis of a mesh comes to. */
typedef struct {
    int n_pitches;   /**< that positions cover: 1, or until the same teeth meet again where errors make them differ */
    int n_positions; /**< position i is i/points pitches from where tooth pair 0 is at the start of contact */
    int n_pairs; /**< places for tooth pairs, by how many pitches they are ahead of the one that came last onto the path */
    int first_pair; /**< of the first place */
    int n_values;
    double torque; /**< nominal one of the driving wheel [N m]; < 0: it presses the coast flanks, 0: no load */
} evl_static_plan;

/** @param points  positions a pitch, at least 21
 *  @return EVL_OK, or EVL_INVALID_INPUT for a mesh that has no such analysis: no real gears, a law other than johnson, a contact
 *          ratio below 1 without tip edges; or for points */
EVL_API int evl_gearbox_static_plan(const evl_gearbox *gearbox, int mesh, int points, evl_static_plan *plan,
                                    evl_status *status);
/** Where the outputs of EVL_TABLE_OF_STATIC stand among the values. */
EVL_API void evl_gearbox_static_places(const evl_static_plan *plan, int *offsets, int *counts);
/** The mesh at rest under a torque of the driving wheel in its sense of rotation [N m], axles at their reference positions; one below
 *  0 presses the coast flanks. Static values differ between the two flanks.
 *  @param speed   of the driving wheel in its sense [rad/s]: flanks rub as if it turned so; 0: without friction
 *  @param values  [n_values]
 *  @return EVL_OK, EVL_INVALID_INPUT, EVL_OUT_OF_DOMAIN (a tip edge on the mate's fillet, or past its reach), EVL_NO_SOLUTION */
EVL_API int evl_gearbox_static(const evl_gearbox *gearbox, int mesh, int points, double torque, double speed,
                               double *values, evl_status *status);
/** The largest force of a tooth pair at rest under a torque [N], without friction, over 100 positions in each of some pitches, or in
 *  all that differ if these are fewer.
 *  @param first  the first pitch: from its number on, counted from where tooth pair 0 is at the start of contact
 *  @return as `evl_gearbox_static_plan` and `evl_gearbox_static` */
EVL_API int evl_gearbox_static_pair_force(const evl_gearbox *gearbox, int mesh, int first, int pitches, double torque,
                                          double *force, evl_status *status);

/* ---- how this kernel was built --------------------------------------------------------------------------------------------- */

/** Name and version of the compiler. */
EVL_API const char *evl_kernel_compiler(void);

/** The processor compiled for, as -march names it, such as "x86-64" or "x86-64-v4"; "" where the compiler was not told.
 *  Which one it is changes the speed, never a result. */
EVL_API const char *evl_kernel_processor(void);

#ifdef __cplusplus
}
#endif
#endif
