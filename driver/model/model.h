/** The gearbox as a dae and a table of outputs: the driver's only interface to the kernel. */
#pragma once

#include "case/case_schema.h"
#include "case/description.h"
#include "model/model_types.h"

/** Available laws of a block: contact, damping or friction; the caller frees the array. */
evl_kind *model_kinds(const char *block, int *n);

/** Create the gearbox. The description must outlive it. @return NULL with the reason in `error`.
 *  @param wheels  known compliant wheels; NULL: none
 *  @param[in,out] before  NULL, or a model that is no longer needed, whose data speed up the creation of a similar one;
 *                         afterwards it can only be deleted */
model *model_create(const description *description, const evl_wheel_store *wheels, model *before, model_message *error);
/** Add the root stress of all wheels with finite elements. @return false with the reason in `error`.
 *  @param wheels  as in model_create */
bool model_add_root_stress(model *model, const evl_wheel_store *wheels, model_message *error);
/** Add the outputs of the root stress, which no model has at first; before any use of its outputs. @return false if no wheel
 *  has root stress */
bool model_add_root_outputs(model *model);
/** Add the outputs of the flash and contact temperature, which no model has at first; before any use of its outputs.
 *  @return false with the reason in `error` */
bool model_add_temperatures(model *model, model_message *error);
void model_delete(model **model);

const model_facts *model_about(const model *model);
/** Explain why radau does not support the model, if so. */
void model_explain_no_stepper(const model *model, model_message *error);

/** Index of the dae's position that counts the pitches of a mesh or, if that is -1, the revolutions of a wheel. */
int model_position_of(const model *model, int wheel, int mesh);
/** Whether the wheel of a position can rotate: something drives it, or may. */
bool model_can_pass(const model *model, int position_of, const dae_state *start);

int model_n_warnings(const model *model);
void model_warning(const model *model, int index, model_message *warning);

/** An output by its name; NULL if there is none. */
const model_output *model_output_named(const model *model, const char *name);
/** Offset of an output, by its name, in the array filled by model_outputs; -1 if there is none. */
int model_output_offset(const model *model, const char *name);
/** An element of an output, by its name, among values as from model_outputs; NAN if there is no such output. */
double model_output_value(const model *model, const double *values, const char *name, int index);
/** The static outputs, at their offsets among all [n_values]. */
void model_constants(const model *model, double *values);
/** All outputs at a state [n_values]; integers as whole doubles. @return a dae_code */
int model_outputs(const model *model, const dae_state *state, double *values, char message[DAE_MESSAGE_LENGTH]);

/** Evaluates a selection of outputs at many states. */
typedef struct model_sampler model_sampler;
/** @param requested  [n] indices of outputs. The model must outlive the sampler */
model_sampler *model_sampler_create(const model *model, int n, const int *requested);
void model_sampler_delete(model_sampler **sampler);
/** Evaluate at n states with one discrete state, as in a step; DAE_LANES at once are fastest.
 *  @param t, y      [n], [states * n] for each state variable its n values
 *  @param discrete  has the discrete state
 *  @param values    the requested outputs in order, for each value the n states. @return a dae_code */
int model_sampler_ask(const model_sampler *sampler, int n, const double *t, const double *y, const dae_state *discrete,
                      double *values, char message[DAE_MESSAGE_LENGTH]);
/** Evaluate at one state. @param check  as in model_sampler_lanes */
int model_sampler_at(const model_sampler *sampler, bool check, const dae_state *state, double *values,
                     char message[DAE_MESSAGE_LENGTH]);
/** As model_sampler_ask at DAE_LANES states, only the first n of which count; the others must be valid states, such as
 *  repetitions of the last one.
 *  @param check  return DAE_RECOVERABLE if y does not agree with the discrete state: an event before it was missed */
int model_sampler_lanes(const model_sampler *sampler, int n, bool check, const double *t, const double *y,
                        const dae_state *discrete, double *values, char message[DAE_MESSAGE_LENGTH]);
/** Whether DAE_LANES states together cost less than one by one. */
bool model_sampler_in_lanes(const model_sampler *sampler);
enum { MODEL_ROOT_POINTS = 33 }; /**< equidistant points of a fillet */
/** Whether a mesh has a friction law whose arguments may be held at limits. */
bool model_has_friction_limits(const model *model);
/** Whether no law holds an argument at a state. If one does, `found` describes the first one. */
bool model_check_friction_limits(const model *model, const dae_state *state, model_message *found);
/** Largest number of teeth that model_sampler_root_points returns. */
int model_root_teeth(const model *model);
/** Root stress at the points of the teeth near a load of a wheel, at the states of the last evaluation of a sampler of the root
 *  stress. @param values  [most * 2 * MODEL_ROOT_POINTS * n] for each tooth, fillet and point the n states
 *  @return number of teeth */
int model_sampler_root_points(const model_sampler *sampler, int wheel, int most, int n, double *values);

/** Extreme over the run of an output of a mesh or of its tooth pairs, and the time of its first occurrence. */
typedef struct {
    const char *output;       /**< name of the output */
    model_output value, time; /**< variables of the meshes, static, without offsets */
    int monitored;            /**< index among the watched outputs */
    bool is_largest;          /**< else smallest */
} model_extreme;

/** Data common to all models; valid as long as the program. */
struct model_tables {
    case_schema schema; /**< permitted keys of a case */
    int n_event_kinds;
    const char *const *event_kinds; /**< their names */
    int n_extremes;
    const model_extreme *extremes;
    int n_monitored;       /**< outputs: channel n_monitored * mesh + watched of model_dae belongs to a mesh */
    const char *compiler;  /**< that compiled the kernel */
    const char *processor; /**< target processor of the kernel, in the terms of -march; "" if not specified */
};
const struct model_tables *model_tables(void);
const case_schema *model_schema(void);

typedef struct {
    char name[EVL_SHORT_LENGTH], units[EVL_SHORT_LENGTH];
} model_state;
/** Names and units of the states, a new array with one element for each state of the dae. */
model_state *model_states(const model *model);

/** Parameters of the damping law of a mesh, with defaults filled in. */
enum { MODEL_MOST_PARAMETERS = 8 };
void model_damping(const model *model, int mesh, double parameters[MODEL_MOST_PARAMETERS]);

enum { MODEL_ROOT_ARCS = 13 };
/** Influence of loads on the root stress of a wheel, as evl_gearbox_root_influence, after model_add_root_stress.
 *  @param arcs  [MODEL_ROOT_ARCS]
 *  @return false if the wheel has no root stress */
bool model_root_influence(const model *model, int wheel, int n, const int *flanks, const double *rho, const int *teeth,
                          double *arcs, double *stress);

/** Unit vectors of the directions in which the support of a wheel allows displacements. @return their number */
int model_support_directions(const model *model, int wheel, double directions[2][2]);

/** Gears and meshes of a case refused by model_create, only for model_geometry and model_pitch_errors.
 *  @return NULL if the case has none */
model *model_sketch(const description *description);

/** Geometry derived from the case. @return number of quantities, 0 for a model without that kind of element */
int model_geometry(const model *model, evl_of of, int index, evl_output quantities[EVL_MOST_QUANTITIES]);
/** One of these quantities by its name, NaN if there is none. */
double model_quantity(const model *model, evl_of of, int index, const char *name);
/** Data sheet of a mesh. @return a new array */
evl_sheet_row *model_datasheet(const model *model, int mesh, int *n);
/** K_V of the data sheet: ISO 6336-1, method B. NaN where it is not defined, also in a gearbox of several meshes.
 *  @param of_class  with the tolerances of the classes of both gears; else without deviations */
double model_iso_dynamic_factor(const model *model, int mesh, bool of_class);
/** Circles and points of the drawing of a mesh. */
void model_mesh_picture(const model *model, int mesh, evl_mesh_picture *picture);
/** Outline of neighbouring teeth in that drawing, as evl_gearbox_mesh_outline. @return a new array of x, y [m] */
double *model_mesh_outline(const model *model, int mesh, int driven, int teeth, int *n);
/** Cumulative pitch deviations of a wheel's teeth [m]. @return their number, 0 if the wheel has no pitch deviations; at
 *  most `most` of them are written */
int model_pitch_errors(const model *model, int wheel, int most, double *errors);

/** Parameter `index`, from 0, among the numbers and lists of numbers of the case. @return its numbers, to be freed;
 *  NULL if there is no such parameter */
double *model_parameter_at(const model *model, int index, evl_parameter *parameter);
