/** The gearbox as a dae and as a table of outputs: the driver's only door to the kernel. */
#pragma once

#include "case/case_schema.h"
#include "case/description.h"
#include "integrate/dae.h"

/** One variable of the history: constant over time (is_static) or one value, or array of values, a time. */
typedef struct {
    const char *name, *units, *symbol, *long_name; /**< live as long as the program */
    const char *dims; /**< words of the dimensions besides time: "", "wheel", "mesh axis" and so on */
    bool is_static, is_integer;
    int offset, count;   /**< place in the array that model_outputs fills; count 0: the case has no such variable */
    const char *rate_of; /**< output of which it is the rate, as of evl_output; NULL: none */
} model_output;

/** Why a description was refused, or what it is warned of; with what it is about, so that the case file can be shown at the place. */
typedef struct {
    char field[192]; /**< path in the case, "" if it is about nothing in particular */
    char message[DAE_MESSAGE_LENGTH];
} model_message;

/** What a start is about that is about nothing in particular. */
#define MODEL_START "simulation.initial"

typedef struct model model;

/** The laws of a block: contact, damping or friction; the caller frees the array. */
evl_kind *model_kinds(const char *block, int *n);

/** Make the gearbox. The description has to outlive it. @return NULL with the reason in `error`.
 *  @param wheels  known ones that give way; NULL: none is
 *  @param[in,out] before  NULL, or a model that is not needed any more, which makes one like it cheap: it can only be deleted then */
model *model_create(const description *description, const evl_wheel_store *wheels, model *before, model_message *error);
void model_delete(model **model);

typedef struct {
    int n;
    const char *const *names; /**< [n] */
} name_list;

/** The names of what the values of a model belong to. */
typedef struct {
    name_list wheels, meshes, shafts, accelerometers;
    name_list pairs; /**< places for the tooth pairs of a mesh: drive_0, drive_1, ..., coast_0, ... */
} model_names;

/** What is fixed of a model. */
typedef struct {
    dae dae; /**< its stepper is the kernel's integrator radau, if that serves the model */
    model_names names;
    int n_outputs, n_values;     /**< n_values: numbers of all outputs at a state */
    const model_output *outputs; /**< [n_outputs] */
} model_facts;
const model_facts *model_about(const model *model);
/** Why it does not, if so. */
void model_explain_no_stepper(const model *model, model_message *error);

/** Which of the dae's positions are the pitches of a mesh or, if that is -1, the turns of a wheel. */
int model_position_of(const model *model, int wheel, int mesh);
/** Whether anything turns the wheel by which a position goes, or may. */
bool model_can_pass(const model *model, int position_of, const dae_state *start);

int model_n_warnings(const model *model);
void model_warning(const model *model, int index, model_message *warning);

/** An output by its name; NULL if there is none. */
const model_output *model_output_named(const model *model, const char *name);
/** Place of an output, by its name, in the array that model_outputs fills; -1 if there is none. */
int model_output_offset(const model *model, const char *name);
/** An element of an output, by its name, among values as of model_outputs; NAN if there is no such output. */
double model_output_value(const model *model, const double *values, const char *name, int index);
/** The static outputs, where they stand among all [n_values]. */
void model_constants(const model *model, double *values);
/** All outputs at a state [n_values]; integers as whole doubles. @return a dae_code */
int model_outputs(const model *model, const dae_state *state, double *values, char message[DAE_MESSAGE_LENGTH]);

/** Asks for some outputs at many states. */
typedef struct model_sampler model_sampler;
/** @param wanted  [n] indices of outputs. The model has to outlive it */
model_sampler *model_sampler_create(const model *model, int n, const int *wanted);
void model_sampler_delete(model_sampler **sampler);
/** At n states of one discrete state, as in a step; eight at once are quickest.
 *  @param t, y      [n], [states * n] of each state the n values side by side
 *  @param discrete  where the discrete state is taken from
 *  @param values    one wanted output behind the other, of each value the n states side by side. @return a dae_code */
int model_sampler_ask(const model_sampler *sampler, int n, const double *t, const double *y, const dae_state *discrete,
                      double *values, char message[DAE_MESSAGE_LENGTH]);
/** At one state. @param check  as of model_sampler_lanes */
int model_sampler_at(const model_sampler *sampler, bool check, const dae_state *state, double *values,
                     char message[DAE_MESSAGE_LENGTH]);
/** As model_sampler_ask at DAE_LANES states, of which the first n count; the others are any that have an answer, as the last one once more.
 *  @param check  whether it is DAE_RECOVERABLE if y does not agree with the discrete state: an event before it was missed */
int model_sampler_lanes(const model_sampler *sampler, int n, bool check, const double *t, const double *y,
                        const dae_state *discrete, double *values, char message[DAE_MESSAGE_LENGTH]);
/** Whether so many states cost less than as many times one. */
bool model_sampler_in_lanes(const model_sampler *sampler);

/** An extreme over the run of an output of a mesh, or of its tooth pairs, and the time at which it was first reached. */
typedef struct {
    const char *output;       /**< of which output */
    model_output value, time; /**< variables of the meshes, static, without places */
    int watched;              /**< which of the watched outputs */
    bool is_largest;          /**< else the smallest */
} model_extreme;

/** What is the same for all models; lives as long as the program. */
struct model_tables {
    case_schema schema; /**< what a case may say */
    int n_event_kinds;
    const char *const *event_kinds; /**< their names */
    int n_extremes;
    const model_extreme *extremes;
    int n_watched;         /**< outputs: channel n_watched * mesh + watched of model_dae is one of a mesh */
    const char *compiler;  /**< that built the kernel */
    const char *processor; /**< for which it was compiled, as -march names it; "" if none was named */
};
const struct model_tables *model_tables(void);
const case_schema *model_schema(void);

typedef struct {
    char name[EVL_SHORT_LENGTH], units[EVL_SHORT_LENGTH];
} model_state;
/** What the states are, a new array of as many as its dae has. */
model_state *model_states(const model *model);

/** The parameters of the damping law of a mesh, with what the case left open filled in. */
enum { MODEL_MOST_PARAMETERS = 8 };
void model_damping(const model *model, int mesh, double parameters[MODEL_MOST_PARAMETERS]);

/** Directions in which the support of a wheel lets its axle move, unit vectors. @return how many */
int model_support_directions(const model *model, int wheel, double directions[2][2]);

/** Of a case that model_create refuses: its gears and their meshes, for model_geometry and model_pitch_errors alone.
 *  @return NULL if the case has none */
model *model_sketch(const description *description);

/** The geometry that follows from the case. @return how many quantities there are, 0 where it is not what they are of */
int model_geometry(const model *model, evl_of of, int index, evl_output quantities[EVL_MOST_QUANTITIES]);
/** One of these by its name, NaN if there is none such. */
double model_quantity(const model *model, evl_of of, int index, const char *name);
/** Cumulative position deviations of a wheel's teeth [m]. @return how many there are, 0 if it has no pitch errors; `most` of
 *  them are written */
int model_pitch_errors(const model *model, int wheel, int most, double *errors);

/** Parameter `index`, from 0, of the numbers, or lists of them, that the case gives. @return its numbers, to be freed; NULL if there is
 *  no such parameter */
double *model_parameter_at(const model *model, int index, evl_parameter *parameter);
