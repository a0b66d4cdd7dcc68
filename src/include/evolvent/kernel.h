/** evolvent kernel: dynamics of spur gearboxes, as one C interface.
 *
 *  evl_gearbox_create creates a gearbox. It is immutable except for its inputs, which the owner sets with evl_gearbox_feed, and the
 *  root stress of its wheels, which the owner adds with evl_gearbox_add_root_stress. All variables form a state, which the caller
 *  stores in plain arrays; evl_gearbox_sizes returns their lengths:
 *
 *    y, yp     [n_states]    continuous state and its time derivative, SI units
 *    integers  [n_integers]  discrete state: revolutions of the reference wheel, teeth passed, contact and friction modes, table segments
 *    reals     [n_reals]     discrete state: approach speed at the last closing of each tooth contact
 *
 *  Each call depends on (gearbox, state) only. It prints nothing, stores nothing, and can run in any number of threads on the
 *  same gearbox. Every call that can fail returns an evl_code. On failure it also fills `status`, unless that is NULL, with one
 *  sentence that names the symbol, its value and its unit.
 *
 *  SI units and radians throughout; angles, angular velocities and torques are positive counterclockwise. */
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

/** Return codes. EVL_OUT_OF_DOMAIN is recoverable: the trial state is outside the domain of the model, and a smaller step may succeed. */
typedef enum {
    EVL_OK = 0,
    EVL_INVALID_INPUT = 1, /**< a parameter is invalid; subject, index and field identify it */
    EVL_OUT_OF_DOMAIN = 2, /**< the state is outside the domain of a law, such as limit (15) of the Johnson force */
    EVL_SINGULAR = 3,      /**< a linear system is singular at this state */
    EVL_NO_SOLUTION = 4,   /**< no solution (steady state, orbit, step) exists, or none was found */
    EVL_NO_MEMORY = 5,
    EVL_STORE_FAILED = 6 /**< the caller's evl_wheel_store reported a failure */
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
    int subject;                      /**< evl_subject: subject of the message */
    int index;                        /**< index of the wheel, mesh, load or shaft, from 0; -1 if none */
    char field[EVL_FIELD_LENGTH];     /**< key of the invalid parameter in the block of the subject; "" if none */
    char message[EVL_MESSAGE_LENGTH]; /**< one sentence without a final newline; "" if there is no message */
} evl_status;

/* ---- description of a gearbox ---------------------------------------------------------------------------------------------- */

/** Get the table of all rows, the same for every case. Rows of a block are contiguous; the row that selects the variant is
 *  first. @return number of rows; at most `most` of them are written */
EVL_API int evl_rows(int most, evl_row *rows);
/** Get the variants of a block: contact, damping, friction, load, support. For "event": the event kinds, indexed by the `kind` of
 *  evl_event. @return number of variants; at most `most` of them are written */
EVL_API int evl_kinds(const char *block, int most, evl_kind *kinds);

typedef struct evl_description evl_description;

/** Create a description from entries, which are copied. Checks that every number is in its range and every block is complete. Keys
 *  with a default may be omitted, and so may keys that the kernel does not read, such as the duration.
 *  @return NULL on failure, with the reason in `status` */
EVL_API evl_description *evl_description_create(int n, const evl_entry *entries, evl_status *status);
/** Convert a description that is no longer needed into another one at low cost. The entries must be identical except for their
 *  numbers, and changed numbers are checked.
 *  @return false if the entries differ otherwise, or if a number is invalid: then the description can only be deleted, and
 *  evl_description_create returns the reason */
EVL_API bool evl_description_renew(evl_description *description, int n, const evl_entry *entries);
/** Delete a description and set the pointer to NULL. No effect if it is already NULL. */
EVL_API void evl_description_delete(evl_description **description);
/** Path in the case, as in --set, of the subject of a status, as precise as the case allows; "" for the case as a whole. */
EVL_API void evl_description_path(const evl_description *description, const evl_status *status,
                                  char path[EVL_PATH_LENGTH]);

/** Get parameter `index` (from 0), in the order of the description, and at most `most` of its n numbers. @return whether it exists */
EVL_API bool evl_description_parameter(const evl_description *description, int index, evl_parameter *parameter,
                                       int most, double *numbers);
/** Set the numbers [n] of a parameter; existing gearboxes do not change. @return EVL_OK, or EVL_INVALID_INPUT: the old values remain */
EVL_API int evl_description_set(evl_description *description, int index, const double *numbers, evl_status *status);

/* ---- gearbox --------------------------------------------------------------------------------------------------------------- */

typedef struct evl_gearbox evl_gearbox;

/** Create a gearbox: compute radii, centres and all derived geometry. Meshes and shafts must connect all wheels.
 *  @param store  cache of compliant wheels, used only in this call; NULL: each different wheel is computed
 *  @return the gearbox, which is independent of the description; NULL on failure, with the reason in `status` */
EVL_API evl_gearbox *evl_gearbox_create(const evl_description *description, const evl_wheel_store *store,
                                        evl_status *status);
/** Add the root stress of all wheels with finite elements: the quantities of EVL_OF_ROOT_STRESS and the
 *  outputs of the static analysis require it. No other call that
 *  uses the root stress of the gearbox may run at the same time. No effect if it was added before.
 *  @param description, store  as for evl_gearbox_create
 *  @return EVL_OK, or the error of the store */
EVL_API int evl_gearbox_add_root_stress(evl_gearbox *gearbox, const evl_description *description,
                                        const evl_wheel_store *store, evl_status *status);
/** Add the outputs of the root stress, after evl_gearbox_add_root_stress and before any call that uses outputs: n_values and the layout
 *  of the outputs change. @return false if no wheel has root stress: no effect */
EVL_API bool evl_gearbox_add_root_outputs(evl_gearbox *gearbox);
/** Add the outputs of the flash and contact temperature, before any call that uses outputs: n_values and the layout of the outputs
 *  change. No effect if they were added before.
 *  @param description  as for evl_gearbox_create
 *  @return EVL_OK; EVL_INVALID_INPUT if a mesh has no friction or no bulk temperature, or a material no thermal data */
EVL_API int evl_gearbox_add_temperatures(evl_gearbox *gearbox, const evl_description *description, evl_status *status);
/** Delete a gearbox and set the pointer to NULL. No effect if it is already NULL. */
EVL_API void evl_gearbox_delete(evl_gearbox **gearbox);

typedef struct {
    int n_wheels, n_meshes, n_loads, n_states, n_integers, n_reals, n_roots, n_outputs, n_values, n_warnings;
    int n_pair_slots;  /**< slots in the outputs for the tooth pairs of a mesh */
    int n_drive_slots; /**< number of these slots for the drive flank; they come first */
    int n_shafts;
    int n_events; /**< maximum number of simultaneous events */
    int n_cached; /**< length of `cached` of evl_gearbox_roots_and_monitored */
} evl_sizes;

EVL_API void evl_gearbox_sizes(const evl_gearbox *gearbox, evl_sizes *sizes);

/** Get warning `index` (from 0) of the creation: a valid but questionable parameter. Subject, index and field identify it as for an
 *  error; the code is EVL_OK. If `initial` is not NULL, one further warning may follow: speeds of the loads or the initial condition
 *  above 1e5 rad/s. @return whether the warning exists */
EVL_API bool evl_gearbox_warning(const evl_gearbox *gearbox, const evl_initial *initial, int index,
                                 evl_status *warning);

/** Get the derived quantities of a wheel or a mesh, depending on `of` (evl_of). quantities: [EVL_MOST_QUANTITIES].
 *  @return number of quantities; 0 if the wheel or mesh is not of that kind */
EVL_API int evl_gearbox_geometry(const evl_gearbox *gearbox, int of, int index, evl_output *quantities);
/** The same for a description from which no gearbox can be created: EVL_OF_GEAR for gears that are valid, EVL_OF_GEAR_MESH for their
 *  meshes, even if they cannot mesh; 0 quantities otherwise. */
EVL_API int evl_description_geometry(const evl_description *description, int of, int index, evl_output *quantities);
/** Get the cumulative pitch deviations of the teeth of a wheel, as arcs on the reference circle [m]; at most `most` are written.
 *  @return their number, one per tooth; 0 if the wheel has no pitch errors */
EVL_API int evl_gearbox_pitch_errors(const evl_gearbox *gearbox, int wheel, int most, double *errors);
/** Data sheet of a mesh; at most `most` rows are written. @return their number */
EVL_API int evl_gearbox_datasheet(const evl_gearbox *gearbox, int mesh, int most, evl_sheet_row *rows);
/** Circles and points of the drawing of a mesh. */
EVL_API void evl_gearbox_mesh_picture(const evl_gearbox *gearbox, int mesh, evl_mesh_picture *picture);
/** Outline of `teeth` neighbouring teeth (an odd number) of a gear in that drawing, counterclockwise: x, y of each point [m]; at most
 *  `most` points are written. @return their number; 0 for a gear without basic rack */
EVL_API int evl_gearbox_mesh_outline(const evl_gearbox *gearbox, int mesh, int driven, int teeth, int most,
                                     double *points);
enum { EVL_ROOT_ARCS = 13 };
/** Arcs of the fillets of a wheel at which the root stress is known, from the form circle [m], after evl_gearbox_add_root_stress.
 *  @return EVL_ROOT_ARCS; 0 if the wheel has no root stress */
EVL_API int evl_gearbox_root_arcs(const evl_gearbox *gearbox, int wheel, double arcs[EVL_ROOT_ARCS]);
/** Tangential stress at these arcs of a tooth under unit line loads on the flanks of a wheel with root stress [1/m], equations RS1 and RS3.
 *  @param flanks  [n] 0: right flank, 1: left flank of the loaded tooth; the right flank faces counterclockwise
 *  @param rho     [n] radius of curvature of the flank at the load [m]
 *  @param teeth   [n] index of the loaded tooth minus that of the stressed one, counterclockwise
 *  @param stress  [n][2][EVL_ROOT_ARCS] of the right fillet, then of the left one */
EVL_API void evl_gearbox_root_influence(const evl_gearbox *gearbox, int wheel, int n, const int *flanks,
                                        const double *rho, const int *teeth, double *stress);
/** Directions in which the support of a wheel is movable: unit vectors (x, y), one after the other. @return their number, 0 to 2 */
EVL_API int evl_gearbox_support_directions(const evl_gearbox *gearbox, int wheel, double directions[4]);

/** Parameters of the damping law of a mesh, in the order of its rows; parameters not given in the case are filled in. */
EVL_API void evl_gearbox_damping(const evl_gearbox *gearbox, int mesh, double parameters[EVL_MAX_PARAMETERS]);
/** Compute y, yp, integers and reals at time t from the initial condition. @return EVL_OK, EVL_INVALID_INPUT (initial values
 *  inconsistent with each other or with the loads), EVL_NO_SOLUTION (no steady state), EVL_OUT_OF_DOMAIN. */
EVL_API int evl_gearbox_initial_state(const evl_gearbox *gearbox, const evl_initial *initial, double t, double *y,
                                      double *yp, int *integers, double *reals, evl_status *status);

/** Absolute scales for error control, computed from the loads and the initial condition: state[i] is the scale of errors of y[i],
 *  row[i] the scale of residual i.
 *  @param duration  duration of the run [s]; limits the time in which loads supply energy to a mounted housing */
EVL_API void evl_gearbox_scales(const evl_gearbox *gearbox, const evl_initial *initial, double duration, double *state,
                                double *row);

/** Name of state `index`, with the number of its wheel or mesh, such as "angle_deviation_1", and its unit. Wheels on a common rigid
 *  shaft share one deviation, named after the first of them. */
EVL_API void evl_gearbox_state_name(const evl_gearbox *gearbox, int index, char name[EVL_SHORT_LENGTH],
                                    char units[EVL_SHORT_LENGTH]);

/** Residual F(t, y, y') of the equations F = 0, row i in its own unit. Allocates nothing. @return EVL_OK or EVL_OUT_OF_DOMAIN. */
EVL_API int evl_gearbox_residual(const evl_gearbox *gearbox, double t, const double *y, const double *yp,
                                 const int *integers, const double *reals, double *residual, evl_status *status);
/** Analytic Jacobian dF/dy + cj dF/dy', column-major [n_states * n_states]. */
EVL_API int evl_gearbox_jacobian(const evl_gearbox *gearbox, double t, double cj, const double *y, const double *yp,
                                 const int *integers, const double *reals, double *jacobian, evl_status *status);
/** The sparse Jacobian: only the entries that can be nonzero at some state. The gearbox must outlive it. */
typedef struct evl_pattern evl_pattern;
/** @return NULL if every entry can be nonzero: for a mounted housing */
EVL_API evl_pattern *evl_pattern_create(const evl_gearbox *gearbox, int *n_entries);
/** Delete; sets *pattern to NULL. */
EVL_API void evl_pattern_delete(evl_pattern **pattern);
/** Row and column indices of the entries, from 0, in column order, sorted by row within each column: [n_entries] */
EVL_API void evl_pattern_indices(const evl_pattern *pattern, int *rows, int *columns);
/** As evl_gearbox_jacobian, but only the entries of the pattern: [n_entries] */
EVL_API int evl_pattern_jacobian(const evl_pattern *pattern, double t, double cj, const double *y, const double *yp,
                                 const int *integers, const double *reals, double *values, evl_status *status);
/** Time derivative y' at y: the explicit right-hand side. For tracked meshes LAPACK solves the linear system of the differential
 *  form, so algebraic states get their true derivative too. */
EVL_API int evl_gearbox_derivative(const evl_gearbox *gearbox, double t, const double *y, const int *integers,
                                   const double *reals, double *yp, evl_status *status);

/* ---- events ---------------------------------------------------------------------------------------------------------------- */

typedef struct {
    int kind;       /**< index in the table of event kinds, from 0 */
    int mesh;       /**< index of the mesh; -1 without mesh */
    int tooth_pair; /**< index after the event: pitches since the start; -1 without mesh */
    int flank;      /**< evl_flank; -1 without mesh */
} evl_event;

typedef enum {
    EVL_FLANK_DRIVE = 0, /**< the flank under load if the driving wheel drives in its nominal sense of rotation */
    EVL_FLANK_COAST = 1  /**< the opposite flank */
} evl_flank;

/** Root functions [n_roots], each scaled to be of order 1; those that are inactive in the current mode are 1. */
EVL_API int evl_gearbox_roots(const evl_gearbox *gearbox, const double *y, const int *integers, const double *reals,
                              double *values, evl_status *status);
/** Active crossing directions [n_roots] in the current mode: +1 rising, -1 falling, 0 inactive. Call again after each event. */
EVL_API void evl_gearbox_root_directions(const evl_gearbox *gearbox, const int *integers, int *directions);
/** Time of the next knot of a table; +infinity if there is none. */
EVL_API double evl_gearbox_next_time_event(const evl_gearbox *gearbox, const int *integers);
/** Apply the events at time t: `fired` [n_roots] as from IDAGetRootInfo (0, +1, -1); `time_event` if t is the time from
 *  evl_gearbox_next_time_event. Changes y, integers, reals and computes a consistent yp. events: [n_events].
 *  @return EVL_OK; the number of events in *n_events. */
EVL_API int evl_gearbox_apply_event(const evl_gearbox *gearbox, double t, const int *fired, bool time_event, double *y,
                                    double *yp, int *integers, double *reals, evl_event *events, int *n_events,
                                    evl_status *status);

/* ---- inputs ---------------------------------------------------------------------------------------------------------------- */

/** A load given by one number, which the caller can change during the motion: a constant torque, or a prescribed speed without
 *  a table. */
typedef struct {
    int load;      /**< index for evl_gearbox_feed */
    int wheel;     /**< index of the wheel on which it acts */
    int index;     /**< index among the loads of that wheel, from 0 */
    bool is_speed; /**< a speed; else a torque */
    double value;  /**< current value [N m] or [rad/s] */
} evl_input;

/** Get input `index` (from 0) of a gearbox, in the order of the wheels. @return whether it exists */
EVL_API bool evl_gearbox_input(const evl_gearbox *gearbox, int index, evl_input *input);
/** Set an input; the only call that changes a gearbox. No other call on the gearbox may run at the same time; an integration of it
 *  continues with evl_radau_restart.
 *  @param value  torque [N m], or the speed [rad/s], which is used only at the start of a motion: later the wheel keeps its own speed
 *  @param rate   for a speed: its rate of change [rad/s^2] from then on; 0 for a torque */
EVL_API void evl_gearbox_feed(evl_gearbox *gearbox, int load, double value, double rate);
/** Angular velocity of a wheel [rad/s], relative to the ground, or to the housing if its prescribed speed is relative to the housing. */
EVL_API double evl_gearbox_wheel_speed(const evl_gearbox *gearbox, int wheel, double t, const double *y);

/* ---- integration ----------------------------------------------------------------------------------------------------------- */

/** An integration of a gearbox in closed form, y' = f(t, y), by Radau IIA of order 13 with event location. It holds all variable
 *  data: any number of integrations may run concurrently, also of one gearbox, which must outlive them. */
typedef struct evl_radau evl_radau;

/** Outcome of evl_radau_advance. */
typedef enum {
    EVL_RADAU_STEP = 0,  /**< an ordinary step */
    EVL_RADAU_EVENT = 1, /**< a step that ends at a zero of root functions */
    EVL_RADAU_STOP = 2   /**< a step that ends at t_stop */
} evl_radau_outcome;

/** Cost since evl_radau_start. */
typedef struct {
    int steps;            /**< accepted steps */
    int rejections;       /**< steps repeated because of their error or a failed iteration */
    int evaluations;      /**< evaluations of f, counting each of the seven stages */
    int iterations;       /**< Newton iterations */
    int jacobians;        /**< Jacobian evaluations */
    int factorisations;   /**< factorisations of the systems of all stages together */
    int root_evaluations; /**< evaluations of the root functions beyond one per step */
    /* the fastest growing mode, if steps were shortened because of a growing mode: docs/theory/radau.md */
    double growth_t;         /**< time of occurrence [s] */
    double growth_rate;      /**< growth rate, the real part of its eigenvalue [1/s]; 0: no such mode */
    double growth_frequency; /**< imaginary part [rad/s], >= 0 */
} evl_radau_counts;

/** Check whether this integrator supports the gearbox. @return EVL_OK, or EVL_INVALID_INPUT with the reason: a rigid contact,
 *  tracked contact points, a mounted housing. */
EVL_API int evl_radau_serves(const evl_gearbox *gearbox, evl_status *status);

/** @param scale      [n_states] error scales, as from evl_gearbox_scales; those of the reference angle and speed are
 *                    tightened
 *  @param tolerance  error of a step in these units, 1e-13 to 0.1
 *  @param max_step   maximum step size [s] > 0
 *  @return NULL on failure, with EVL_INVALID_INPUT or EVL_NO_MEMORY in status */
EVL_API evl_radau *evl_radau_create(const evl_gearbox *gearbox, const double *scale, double tolerance, double max_step,
                                    evl_status *status);
/** Delete; accepts NULL and a pointer to NULL; sets *radau to NULL. */
EVL_API void evl_radau_delete(evl_radau **radau);

/** Start at (t, y) with all counts 0. @return EVL_OK or EVL_OUT_OF_DOMAIN. */
EVL_API int evl_radau_start(evl_radau *radau, double t, const double *y, const int *integers, const double *reals,
                            evl_status *status);
/** Make one step from the end of the last one, at most to t_stop > t and at most to the next event. Allocates nothing.
 *  @param[out] t, y     end of the step
 *  @param[out] fired    [n_roots] +1 rising through zero, -1 falling, 0 no crossing
 *  @param[out] outcome  evl_radau_outcome
 *  @return EVL_OK, EVL_OUT_OF_DOMAIN (the model cannot be evaluated for any step), EVL_NO_SOLUTION (the step size became too small) */
EVL_API int evl_radau_advance(evl_radau *radau, double t_stop, double *t, double *y, int *fired, int *outcome,
                              evl_status *status);
/** Interpolate the state at time t within the last step. */
EVL_API void evl_radau_interpolate(const evl_radau *radau, double t, double *y);
/** The same for n states only; the others are unchanged. */
EVL_API void evl_radau_interpolate_some(const evl_radau *radau, double t, int n, const int *states, double *y);
/** The same at EVL_LANES times: y [n_states * EVL_LANES], the values of one state at all times contiguous. */
EVL_API void evl_radau_interpolate_lanes(const evl_radau *radau, const double *t, double *y);
/** Continue after an event from (t, y) and the discrete state returned by evl_gearbox_apply_event. */
EVL_API void evl_radau_restart(evl_radau *radau, double t, const double *y, const int *integers, const double *reals);
/** Discard the last step: return its start in (t, y) and continue from there with smaller steps. */
EVL_API void evl_radau_redo(evl_radau *radau, double *t, double *y);
EVL_API void evl_radau_get_counts(const evl_radau *radau, evl_radau_counts *counts);

/** Operation of evl_radau_serialize. */
typedef enum {
    EVL_SERIALIZE_MEASURE = 0, /**< only count the words */
    EVL_SERIALIZE_WRITE = 1,   /**< write all variable data of an integration to `words` */
    EVL_SERIALIZE_READ = 2     /**< read them into one created for the same gearbox, scales, tolerance and max_step */
} evl_serialize_operation;
/** Save or restore an integration between two calls of evl_radau_advance. A restored integration continues with bitwise identical results,
 *  also in another process with the same kernel. It need not have been started before it is restored.
 *  @param words  [n] in an internal format of the kernel; NULL to measure
 *  @return number of words; -1 if it is not n, or if they belong to another gearbox: then the integration must be deleted */
EVL_API int64_t evl_radau_serialize(evl_radau *radau, int direction, int64_t n, int64_t *words);
/** A point of a step at which a channel may exceed its extreme so far. */
typedef struct {
    int channel;        /**< index of the channel as in evl_gearbox_monitored */
    int sense;          /**< 1: maximum, -1: minimum */
    double t;           /**< estimated time [s] */
    double left, right; /**< interval that contains the extreme [s] */
    double value;       /**< estimated value of the channel there */
} evl_candidate;
/** Search the last step of evl_radau_advance for new extremes; call before evl_radau_restart. Allocates nothing.
 *  @param high, low  extremes of each channel so far; +infinity and -infinity to skip a channel
 *  @return number of candidates: usually 0 */
EVL_API int evl_radau_look(evl_radau *radau, const double *high, const double *low);
/** Get a candidate; index: from 0. */
EVL_API void evl_radau_candidate(const evl_radau *radau, int index, evl_candidate *candidate);

/* ---- outputs --------------------------------------------------------------------------------------------------------------- */

/** Tables of outputs, the same for all gearboxes. */
typedef enum {
    EVL_TABLE_OF_STATE = 0,   /**< outputs at a state, n_outputs of every gearbox */
    EVL_TABLE_OF_STATIC = 1,  /**< outputs of the static analysis; those with is_static do not depend on the torque */
    EVL_TABLE_OF_EXTREMES = 2 /**< outputs of a mesh or of its tooth pairs whose extreme over the run is reported */
} evl_table_of;

/** Get a table. @return number of rows; at most `most` of them are written */
EVL_API int evl_table(int of, int most, evl_output *outputs);
/** Offsets and numbers of values of the outputs in the array of evl_gearbox_outputs, in C order; [n_outputs] each. Count 0: the
 *  gearbox does not have the output, for example the pose of a fixed housing. */
EVL_API void evl_gearbox_output_layout(const evl_gearbox *gearbox, int *offsets, int *counts);
/** Values of the constant outputs, at their offsets in [n_values]; NaN for all other outputs. */
EVL_API void evl_gearbox_constants(const evl_gearbox *gearbox, double *values);
/** All outputs at a state, [n_values]; integers as whole doubles, NaN where a quantity is undefined. With `check` the discrete state
 *  must agree with y: every tooth pair is loaded, penetrating or separated according to its modes, to 1e-6 of the reference force and
 *  penetration. @return EVL_OK; EVL_OUT_OF_DOMAIN also if the check fails: an event was missed, which smaller steps may find */
EVL_API int evl_gearbox_outputs(const evl_gearbox *gearbox, double t, const double *y, const int *integers,
                                const double *reals, bool check, double *values, evl_status *status);

/** Number of states that the kernel evaluates at once. */
enum { EVL_LANES = 8 };

/** Evaluator of selected outputs at many states; for use by one thread. */
typedef struct evl_sampler evl_sampler;

/** @param requested  [n] indices in the table of outputs, from 0. The gearbox must outlive the sampler */
EVL_API evl_sampler *evl_sampler_create(const evl_gearbox *gearbox, int n, const int *requested);
/** Whether the sampler evaluates EVL_LANES states at once; else one by one. */
EVL_API bool evl_sampler_in_lanes(const evl_sampler *sampler);
EVL_API void evl_sampler_delete(evl_sampler **sampler);
/** Evaluate the outputs at n states with a common discrete state, as within a step. Eight at once are fastest and give bitwise the same
 *  values as one at a time. Quantities needed only by other outputs are not computed.
 *  @param n_meant the first n_meant states are used; the others may be any valid states, such as copies of the last one
 *  @param check   as for evl_gearbox_outputs
 *  @param t       [n]
 *  @param y       [n_states * n] the n values of each state contiguous
 *  @param values  the selected outputs one after the other, each with the number of values from evl_gearbox_output_layout; for each value
 *                 the n states contiguous. @return as evl_gearbox_outputs */
EVL_API int evl_sampler_ask(evl_sampler *sampler, int n, int n_meant, const double *t, const double *y,
                            const int *integers, const double *reals, bool check, double *values, evl_status *status);
/** Number of equidistant points of a fillet. */
enum { EVL_ROOT_POINTS = 33 };
/** Largest number of teeth that evl_sampler_root_points returns. */
EVL_API int evl_gearbox_root_teeth(const evl_gearbox *gearbox);
/** Root stress at the points of both fillets of all teeth near a load of a wheel, at the n states of the last evl_sampler_ask. The
 *  sampler must have been created for outputs of the root stress.
 *  @param most    teeth for which there is space; more are left out
 *  @param values  [most * 2 * EVL_ROOT_POINTS * n] for each tooth, fillet (right, left) and point the n states contiguous
 *  @return number of teeth; 0 without loads or finite elements */
EVL_API int evl_sampler_root_points(evl_sampler *sampler, int wheel, int most, int n, double *values);

/* ---- extremes -------------------------------------------------------------------------------------------------------------- */

/** All channels at a state [n_monitored * n_meshes], where n_monitored is the number of different `monitored` in the table of extremes. Each of
 *  these outputs is a channel of each mesh: channel n_monitored * mesh + watched. For an output of tooth pairs the channel is the largest
 *  value of the pairs. @return EVL_OK or EVL_OUT_OF_DOMAIN */
EVL_API int evl_gearbox_monitored(const evl_gearbox *gearbox, const double *y, const int *integers, const double *reals,
                                  double *values, evl_status *status);
/** The channels of one mesh, as from evl_gearbox_monitored. Reads only the mesh's states of y; the other values are unchanged. */
EVL_API int evl_gearbox_monitored_mesh(const evl_gearbox *gearbox, int mesh, const double *y, const int *integers,
                                       const double *reals, double *values, evl_status *status);
/** Indices of the states on which the contacts of a mesh depend, in ascending order: [n_states] at most. @return their number */
EVL_API int evl_gearbox_mesh_states(const evl_gearbox *gearbox, int mesh, int *states);
/** Results of evl_gearbox_roots and evl_gearbox_monitored together, at little more than the cost of the first alone. The pressure of
 *  non-involute flanks may be an estimate, accurate to half a percent, where it is at most near * highest.
 *  @param highest  maximum so far of each channel; +infinity to skip a channel, -infinity if all values must be exact
 *  @param cached     [n_cached] previous results for the flanks, owned by the caller: set to zero at first and after each change of the
 *                  discrete state */
EVL_API int evl_gearbox_roots_and_monitored(const evl_gearbox *gearbox, const double *y, const int *integers,
                                            const double *reals, double near, const double *highest, double *cached,
                                            double *roots, double *values, evl_status *status);

/** Whether a mesh has a friction law whose coefficient depends on load and speeds. */
EVL_API bool evl_gearbox_has_local_friction(const evl_gearbox *gearbox);
/** Check whether such a law holds an argument at a limit in a tooth pair that is loaded at a state.
 *  @return EVL_OK; EVL_OUT_OF_DOMAIN with the first such argument in `status` */
EVL_API int evl_gearbox_friction_limits(const evl_gearbox *gearbox, const double *y, const int *integers,
                                        const double *reals, evl_status *status);

/* ---- outputs by position ----------------------------------------------------------------------------------------------------- */

/** Index of the driving wheel of a mesh. */
EVL_API int evl_gearbox_driving_wheel(const evl_gearbox *gearbox, int mesh);
/** Whether a wheel turns or can turn: wheels move at the start (y, yp: [n_states]), or a load or the housing moves it. */
EVL_API bool evl_gearbox_can_turn(const evl_gearbox *gearbox, int wheel, const double *y, const double *yp);
/** Rotation of the driving wheel of a mesh, in pitches, from the position where its unloaded tooth pair 0 is at the start of contact: the
 *  position of the static analysis. It grows in the nominal sense of rotation. Linear in y for constant integers. */
EVL_API double evl_gearbox_pitches(const evl_gearbox *gearbox, int mesh, const double *y, const int *integers);
/** Revolutions of a wheel since its start position, positive in its nominal sense of rotation; likewise linear. */
EVL_API double evl_gearbox_turns(const evl_gearbox *gearbox, int wheel, const double *y, const int *integers);

/* ---- common period ------------------------------------------------------------------------------------------------------------ */

/** Common period: after it, all meshes, teeth with individual errors, harmonic loads and housing motions are in the same phase. */
typedef struct {
    int pitches;  /**< length in pitches of mesh 0 */
    int sense;    /**< of a prescribed speed: +1 nominal sense of rotation, -1 opposite */
    bool by_time; /**< a speed is prescribed: the period is a time; else nothing depends on time: it is an angle */
    double time;  /**< [s] if by_time; else 0 */
} evl_period;
/** @return EVL_OK, or EVL_INVALID_INPUT with the reason if there is no common period */
EVL_API int evl_gearbox_period(const evl_gearbox *gearbox, evl_period *period, evl_status *status);
/** Shift a state back by whole common periods, counted in the nominal sense of rotation. Angles, tooth pairs and their slots become those
 *  of the same phase in the earlier period; the energies are reset. */
EVL_API void evl_gearbox_take_back(const evl_gearbox *gearbox, const evl_period *period, int periods, double *y,
                                   int *integers, double *reals);
/** Distance between two states: the largest difference of a state in its unit scale[i], or of an approach speed in the unit of its
 *  contact; infinite if the discrete states differ. Energies are ignored. */
EVL_API double evl_gearbox_distance(const evl_gearbox *gearbox, const double *scale, const double *y_a,
                                    const int *integers_a, const double *reals_a, const double *y_b,
                                    const int *integers_b, const double *reals_b);
/** Transfer a state of a similar gearbox with other parameters to this gearbox. Prescribed speeds become those of its loads, and all
 *  wheels turn accordingly. Penetrations are unchanged. Tooth pairs and their modes follow from the positions of its teeth.
 *  @param alike  the other gearbox has as many integers and reals: approach speeds are retained; else only the first integer is used
 *  @return EVL_OK, or EVL_OUT_OF_DOMAIN if a law cannot be evaluated there */
EVL_API int evl_gearbox_take_over(const evl_gearbox *gearbox, bool alike, double t, double *y, double *yp,
                                  int *integers, double *reals, evl_status *status);

/* ---- orbits ------------------------------------------------------------------------------------------------------------------- */

/** Continuation of periodic orbits of gearboxes over one parameter; orbits are found by shooting. docs/theory/orbits.md. */
typedef struct evl_orbits evl_orbits;
/** Get the gearbox for a value of the parameter and the scales of its states [n_states]; both are valid until the next call.
 *  @return EVL_OK, or any other code on failure, with the reason in `status` */
typedef int evl_orbits_take(void *self, double value, const evl_gearbox **gearbox, const double **scale,
                            evl_status *status);
/** Integrate the gearbox of the last `take` over `periods` common periods, from a state on the section, to record the results of an
 *  orbit. The run also shows whether it is an orbit.
 *  @param number  from 1, of a point that this call of evl_orbits_advance may add; results recorded before under this number are discarded
 *  @param period  its length [s]; if no speed is prescribed, it is set to the time taken
 *  @param y, integers, reals  set to the state at the end, shifted back to the period of the start
 *  @return EVL_OK, or any other code if the orbit does not close */
typedef int evl_orbits_record(void *self, int number, int periods, double *period, double t, double *y, int *integers,
                              double *reals, evl_status *status);
typedef struct {
    void *self; /**< passed to `take` and `record` */
    evl_orbits_take *take;
    evl_orbits_record *record; /**< for orbits at `values`; NULL: these are found like all others */
    double from, to;           /**< limits of the parameter; the interval counts as 1 along a branch */
    double position;  /**< of the section if a speed is prescribed [pitches of mesh 0 after t = 0]; not at events */
    double tolerance; /**< of the integration, in units of the scales */
    double residual;  /**< tolerance: largest difference after a period, in units of the scales */
    double first_step, smallest_step, largest_step; /**< arclength along a branch, states in units of their scales */
    double straight_step;                           /**< largest step where the branch is straight, if longer */
    double largest_change;                          /**< of the parameter in a step, relative to its range */
    int most_points; /**< of a branch; special points and those at `values` not counted */
    int n_values;
    const double
        *values; /**< [n_values] of the parameter, monotonic, at which each branch gets its stable orbits too */
} evl_orbits_setup;
/** Type of a point of a branch. */
typedef enum {
    EVL_ORBIT_ORDINARY,
    EVL_ORBIT_FOLD,
    EVL_ORBIT_CROSSING, /**< intersection with another branch */
    EVL_ORBIT_DOUBLING,
    EVL_ORBIT_NEIMARK_SACKER,
    EVL_ORBIT_GRAZING, /**< grazing: a root function touches zero without crossing; flanks barely separate. Multipliers are one-sided */
    EVL_ORBIT_GRAZING_FOLD /**< grazing where the branch turns back */
} evl_orbit_kind;
typedef struct {
    double parameter;
    double period;   /**< period of the orbit [s] */
    double residual; /**< in units of the scales */
    int periods;     /**< period of the orbit in common periods */
    int kind;        /**< evl_orbit_kind */
    int mesh;        /**< of a grazing point; else -1 */
    int iterations;  /**< Newton iterations */
    int n_multipliers;
    int recorded; /**< number passed to `record` for this orbit, which has no multipliers; is_stable is that of its neighbours; 0: not recorded */
    bool is_stable;              /**< all multipliers are smaller than 1 in magnitude */
    bool whole_mesh;             /**< of a grazing point: no tooth pair of the mesh is loaded then; false: others are */
    char root[EVL_SHORT_LENGTH]; /**< of a grazing point: name of the root function; else "" */
} evl_orbit;
/** @param value  initial parameter value, whose gearbox defines the scales
 *  @return NULL on failure: EVL_INVALID_INPUT if there is no common period or radau does not support the gearbox; or the code of `take` */
EVL_API evl_orbits *evl_orbits_create(const evl_orbits_setup *setup, double value, evl_status *status);
/** Delete; sets *orbits to NULL. */
EVL_API void evl_orbits_delete(evl_orbits **orbits);
/** Find an orbit by Newton's method from a nearby state and make it the current orbit.
 *  @param periods  period of the orbit in common periods
 *  @param period   estimated period [s] if no speed is prescribed; else ignored
 *  @return EVL_OK; EVL_NO_SOLUTION, EVL_SINGULAR if none was found */
EVL_API int evl_orbits_find(evl_orbits *orbits, double value, int periods, double period, const double *y,
                            const int *integers, const double *reals, evl_orbit *orbit, evl_status *status);
/** Start a new branch at the current orbit; branches are numbered from 0.
 *  @param n  number of its points: 1, or 0 on failure */
EVL_API int evl_orbits_begin(evl_orbits *orbits, bool rising, int *n, evl_status *status);
/** Compute the next point of the last branch. @param n  number of its points, including special ones before the new one, also on failure
 *  @param is_over  the branch has no further points */
EVL_API int evl_orbits_advance(evl_orbits *orbits, int *n, bool *is_over, evl_status *status);
/** State of the continuation of the last branch: the data besides its points on which the next point depends. */
typedef struct {
    double step;
    int crawls, n_ordinary;
    int before;    /**< number, from 1, of the ordinary point before the last; 0: none */
    int is_smooth; /**< the cubic through its last two points predicted the last step better than the tangent */
} evl_orbits_progress;
EVL_API void evl_orbits_walk(const evl_orbits *orbits, evl_orbits_progress *progress);
/** Length of the record of a point, from which another process can compute the same subsequent points. */
EVL_API int evl_orbits_record_length(const evl_orbits *orbits);
EVL_API void evl_orbits_save(const evl_orbits *orbits, int branch, int point, double *numbers);
/** Append a saved point to a branch; the next branch number starts a new branch. @param numbers  NULL: the branch has no point yet */
EVL_API void evl_orbits_put(evl_orbits *orbits, int branch, const double *numbers);
/** Resume at the last point of the last branch after all its points were restored with evl_orbits_put. */
EVL_API int evl_orbits_go_on(evl_orbits *orbits, const evl_orbits_progress *progress, evl_status *status);
/** Switch from a period doubling to the branch of twice the period: its first orbit, at `distance`, becomes the current orbit. */
EVL_API int evl_orbits_switch(evl_orbits *orbits, int branch, int point, double distance, evl_status *status);
/** @param multipliers  [n_multipliers][2] at most one per state and tooth contact: real and imaginary part, in descending magnitude */
EVL_API void evl_orbits_point(const evl_orbits *orbits, int branch, int point, evl_orbit *orbit, double *multipliers);
/** The state of a point on the section, or of the current orbit if `branch` is negative. */
EVL_API int evl_orbits_state(evl_orbits *orbits, int branch, int point, double *t, double *y, int *integers,
                             double *reals, evl_status *status);

/* ---- the periodic start ------------------------------------------------------------------------------------------------------ */

/** Return whether the search must stop before its next integration. */
typedef bool evl_periodic_is_over(void *self);
/** Search setup. */
typedef struct {
    void *self;
    evl_periodic_is_over *is_over; /**< NULL: the search is not interrupted */
    int most_flows;                /**< maximum number of integrations over the common period or a part of it, >= 1 */
} evl_periodic_setup;
/** Result of the periodic start: the orbit found. */
typedef struct {
    int pitches;          /**< common period in pitches of mesh 0; 0: there is none */
    int flows;            /**< integrations made by the search */
    int periods;          /**< common periods over which the motion settled */
    int ties;             /**< coinciding events of the orbit: the multipliers are those of one order of these events */
    double time;          /**< period [s] */
    double residual;      /**< largest difference after a period, in units of the scales */
    double multiplier[2]; /**< the Floquet multiplier of largest magnitude, real and imaginary part; 0: below 1e-10 */
    double time_constant; /**< of the slowest decay [s]; 0: not defined */
    bool has_multiplier;  /**< `multiplier` was computed */
    bool is_stable;       /**< all multipliers are smaller than 1 in magnitude */
    bool is_reached;      /**< the motion from the steady start converges to the orbit */
    bool is_interrupted;
    bool has_searched; /**< the case was not rejected before the first integration */
} evl_periodic;
/** Find the periodic orbit to which the motion from the steady start converges. Fill y, yp, integers and reals with its state at
 *  t = 0, at the mesh position of the steady start. docs/theory/orbits.md.
 *  @return EVL_OK; EVL_INVALID_INPUT (no periodic start is possible, or the search needs more integrations), EVL_NO_SOLUTION (no steady
 *          state, no orbit found, or the search was interrupted), EVL_OUT_OF_DOMAIN */
EVL_API int evl_gearbox_periodic_start(const evl_gearbox *gearbox, const evl_initial *initial,
                                       const evl_periodic_setup *setup, evl_periodic *found, double *y, double *yp,
                                       int *integers, double *reals, evl_status *status);
/** The same without the search: y, yp, integers and reals are set to the steady start; only `pitches` and `time` are computed. */
EVL_API int evl_gearbox_periodic_check(const evl_gearbox *gearbox, const evl_initial *initial, evl_periodic *found,
                                       double *y, double *yp, int *integers, double *reals, evl_status *status);

/* ---- natural modes --------------------------------------------------------------------------------------------------------- */

/** Discrete state of the tooth contact that carries the load of a mesh: the first pair on the drive flank, or the first loaded one if
 *  that is not loaded. */
EVL_API void evl_gearbox_mesh_mode(const evl_gearbox *gearbox, int mesh, const double *y, const int *integers,
                                   const double *reals, evl_mesh_mode *mode);

/** Linearise the gearbox at a state: eigenvalues and eigenvectors of small motions x' = A x, in ascending magnitude.
 *
 *  x: speed of the reference wheel; deviation and its rate of every other rotor; displacements and velocities of the supports.
 *  Prescribed speeds are excluded. The contact modes, the friction branches and the angle of the driving wheel of the first mesh
 *  in the power flow (the one with the highest mesh frequency) are fixed.
 *
 *  @param[out] n_modes      number of eigenvalues, at most n_states
 *  @param[out] n_rigid      number of independent motions without a restoring force; rotation as a whole (theta) is one of them unless
 *                           a speed is prescribed, though theta has no eigenvalue here
 *  @param[out] eigenvalues  [2 * n_states] real and imaginary part [1/s] interleaved, as C's double complex; complex conjugates are
 *                           adjacent, positive imaginary part first; 0 if the eigenvalue is only rounding error
 *  @param[out] vectors      [2 * n_states * n_states] mode by mode, each a change of y of arbitrary magnitude; theta is omega/lambda
 *  @param[out] means  [n_values] NULL, or A is the mean over the steady states at n_positions mesh positions. They are evenly
 *                      spaced over the smallest number of pitches of the first mesh, at most 10000, in which every mesh passes whole
 *                      pitches. means returns the outputs averaged in the same way. y, integers, reals are set to the steady state half
 *                      a pitch from the start of contact, to which the vectors refer
 *  @param n_positions  number of positions of that mean; 0: 997, or 1009 if 997 divides the number of pitches. A smaller number
 *                      should be a prime that does not divide the number of pitches
 *  @return EVL_OK, EVL_OUT_OF_DOMAIN (the state is outside the domain of the model, or forces have no derivative there), EVL_SINGULAR
 *          (accelerations of a mounted housing are undetermined), EVL_NO_SOLUTION (a rigid contact, or LAPACK failed); for the mean also
 *          the codes of evl_gearbox_initial_state if there is no steady state */
EVL_API int evl_gearbox_modes(const evl_gearbox *gearbox, double t, double *y, int *integers, double *reals,
                              int *n_modes, int *n_rigid, double *eigenvalues, double *vectors, double *means,
                              int n_positions, evl_status *status);

/** Changes of outputs due to a small change dy of the state y: first order, linear in dy.
 *  @param[out] arcs                 [n_wheels] r_b phi, r phi of a wheel without a mesh, counterclockwise [m]
 *  @param[out] displacements        [n_wheels][2] of the axles, x and y [m]
 *  @param[out] penetrations         [n_meshes] h [m]
 *  @param[out] transmission_errors  [n_meshes] Delta [m] */
EVL_API void evl_gearbox_shape(const evl_gearbox *gearbox, const double *y, const double *dy, double *arcs,
                               double *displacements, double *penetrations, double *transmission_errors);

/** Distance of a start from the steady motion: start - motion = the sum of Re amplitude_k vector_k over all modes k, which decay as
 *  exp(eigenvalue_k t). The modes are those of the mean of A over one pitch of the first mesh; the steady motion is the linear response
 *  to the static path over this pitch. Modes of eigenvalue 0 have the amplitude 0.
 *  @param start, start_integers  state of the start
 *  @param[out] y, integers, reals  a steady state half a pitch from the start, at which outputs can be linearised
 *  @param[out] n_modes, eigenvalues  as from evl_gearbox_modes
 *  @param[out] vectors     [2 * n_states * n_states] as from evl_gearbox_modes; the largest entry of each is the scale of its state; theta
 *                          is excluded
 *  @param[out] amplitudes  [2 * n_states]
 *  @return as evl_gearbox_modes with `means`; EVL_NO_SOLUTION also if the gearbox has more than 300 states */
EVL_API int evl_gearbox_start_distance(const evl_gearbox *gearbox, double t, const double *start,
                                       const int *start_integers, double *y, int *integers, double *reals, int *n_modes,
                                       double *eigenvalues, double *vectors, double *amplitudes, evl_status *status);

/* ---- static analysis ------------------------------------------------------------------------------------------------------- */

/** Extent of the static analysis of a mesh. */
typedef struct {
    int n_pitches; /**< number of pitches covered: 1, or, if errors make teeth differ, until the same teeth meet again */
    int n_positions; /**< position i is i/points pitches from the position where tooth pair 0 is at the start of contact */
    int n_pairs;     /**< tooth pair slots, by the number of pitches ahead of the pair that entered the path last */
    int first_pair; /**< number of pitches of the first slot */
    int n_wheels;   /**< wheels in the outputs of the root stress: driving, driven; 0: neither has it */
    int n_values;
    double torque; /**< nominal torque of the driving wheel [N m]; < 0: the coast flanks are loaded, 0: no load */
} evl_static_plan;

/** @param points  positions per pitch, at least 21
 *  @return EVL_OK, or EVL_INVALID_INPUT: invalid points, or a mesh without such an analysis (gears without a basic rack, a law other
 *          than johnson, a contact ratio below 1 without tip edges) */
EVL_API int evl_gearbox_static_plan(const evl_gearbox *gearbox, int mesh, int points, evl_static_plan *plan,
                                    evl_status *status);
/** Offsets and numbers of values of the outputs of EVL_TABLE_OF_STATIC in `values`. */
EVL_API void evl_gearbox_static_layout(const evl_static_plan *plan, int *offsets, int *counts);
/** Quasi-static analysis of a mesh under a torque of the driving wheel in its sense of rotation [N m], axles at their reference positions.
 *  A negative torque loads the coast flanks. Static outputs (is_static) differ between the two flanks.
 *  @param speed   of the driving wheel in its sense of rotation [rad/s], for the sliding friction of the flanks; 0: without friction
 *  @param values  [n_values]
 *  @return EVL_OK, EVL_INVALID_INPUT, EVL_OUT_OF_DOMAIN (a tip edge on the mate's fillet, or beyond its range), EVL_NO_SOLUTION */
EVL_API int evl_gearbox_static(const evl_gearbox *gearbox, int mesh, int points, double torque, double speed,
                               double *values, evl_status *status);
/** Largest quasi-static force of a tooth pair under a torque, without friction, also between the positions: 100 in each of `pitches`
 *  pitches, or in all different pitches if these are fewer.
 *  @param first  index of the first pitch, counted from the position where tooth pair 0 is at the start of contact
 *  @param pair_force  [N]
 *  @return as `evl_gearbox_static_plan` and `evl_gearbox_static` */
EVL_API int evl_gearbox_static_largest(const evl_gearbox *gearbox, int mesh, int first, int pitches, double torque,
                                       double *pair_force, evl_status *status);
/** Largest quasi-static root stress of a wheel with root stress (`evl_gearbox_add_root_stress`) under the torques of all its meshes.
 *  @param first, pitches  [meshes] as for evl_gearbox_static_largest
 *  @param torques         [meshes] of the driving wheels [N m]; those of other wheels' meshes are not read
 *  @param stress          [Pa]; NaN if no mesh loads the wheel
 *  @return as `evl_gearbox_static_largest` */
EVL_API int evl_gearbox_static_root(const evl_gearbox *gearbox, int wheel, const int *first, const int *pitches,
                                    const double *torques, double *stress, evl_status *status);

/* ---- how this kernel was built --------------------------------------------------------------------------------------------- */

/** Name and version of the compiler. */
EVL_API const char *evl_kernel_compiler(void);

/** Target processor in the notation of -march, such as "x86-64" or "x86-64-v4"; "" if the compiler got no such option.
 *  It affects the speed, not the results. */
EVL_API const char *evl_kernel_processor(void);

#ifdef __cplusplus
}
#endif
#endif
