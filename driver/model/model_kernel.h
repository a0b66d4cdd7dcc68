/** Shared by the files of the model: the only include of the kernel's header. Private to model/. */
#pragma once

#include "base/memory.h"
#include "model/model_types.h"

#include <evolvent/kernel.h>

struct model {
    evl_description *description;
    evl_gearbox *gearbox;
    memory_arena arena; /**< owns the arrays and names of the facts */
    model_facts about;
    evl_sizes sizes;
    evl_initial initial; /**< its arrays belong to the case's description */
};

/** Convert a run-time status of the kernel to a dae_code and a message with the name of the mesh concerned. */
int model_check_status(const model *model, int code, const evl_status *status, char message[DAE_MESSAGE_LENGTH]);
/** Fill the dae; the model owns its arrays. */
void model_describe_dae(model *model, double duration);
/** The kernel's integrator for the model's dae; NULL if it does not support the gearbox. */
const dae_stepper *model_radau(const model *model);
/** Field and reason of a refusal. */
void model_explain(const model *model, const evl_status *status, model_message *error);
/** Reason why there is no initial state; by default it refers to the case's initial state. */
void model_explain_start(const model *model, const evl_status *status, model_message *error);
/** Outputs of one of the kernel's tables, without offsets, and their texts, which must outlive them: new arrays.
 *  @return their number */
int model_take_outputs(int of, evl_output **texts, model_output **outputs);
/** Fill the table of outputs. */
void model_describe_outputs(model *model);
