#include "base/memory.h"
#include "model/model_kernel.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/** The kernel's names of fields that have another place in a case file. */
static const char *case_field(const char *field)
{
    static const struct {
        const char *kernel, *in_case;
    } names[] = {
        {"paper_rule", "pressure_angle"},
        {"youngs_modulus", "material"},
        {"poisson_ratio", "material"},
        {"density", "material"},
    };
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        if (strcmp(field, names[i].kernel) == 0) {
            return names[i].in_case;
        }
    }
    return field;
}

static void explain(const model *model, const evl_status *status, model_message *error)
{
    *error = (model_message){.subject = MODEL_ABOUT_NOTHING, .index = -1, .load = -1};
    (void)snprintf(error->field, sizeof error->field, "%s", case_field(status->field));
    (void)snprintf(error->message, sizeof error->message, "%s", status->message);
    const bool has_index = status->index >= 0;
    switch (status->subject) {
    case EVL_SUBJECT_WHEEL:
        error->subject = MODEL_ABOUT_WHEEL;
        error->index = status->index;
        break;
    case EVL_SUBJECT_MESH:
        error->subject = MODEL_ABOUT_MESH;
        error->index = status->index;
        break;
    case EVL_SUBJECT_LOAD:
        error->subject = MODEL_ABOUT_LOAD;
        error->index = has_index ? model->wheel_of_load[status->index] : -1;
        error->load = has_index ? model->load_of_load[status->index] : -1;
        break;
    case EVL_SUBJECT_INITIAL:
        error->subject = MODEL_ABOUT_INITIAL;
        error->index = status->index;
        break;
    case EVL_SUBJECT_HOUSING:
        error->subject = MODEL_ABOUT_HOUSING;
        break;
    case EVL_SUBJECT_SHAFT:
        error->subject = MODEL_ABOUT_SHAFT;
        error->index = status->index;
        break;
    default:
        break;
    }
}

model *model_create(const description *description, model_message *error)
{
    evl_status status = {.index = -1};
    model *model = xcalloc(1, sizeof *model);
    model->initial = model_translate_initial(description);
    model->gearbox = model_create_gearbox(model, description, &status);
    if (model->gearbox == NULL) {
        explain(model, &status, error);
        model_delete(&model);
        return NULL;
    }
    evl_gearbox_sizes(model->gearbox, &model->sizes);
    model->mesh_names = xcalloc((size_t)description->n_meshes, sizeof *model->mesh_names);
    for (int i = 0; i < description->n_meshes; i++) {
        model->mesh_names[i] = xstrdup(description->meshes[i].name);
    }
    model_describe_dae(model);
    model_describe_outputs(model);
    return model;
}

int model_support_directions(const model *model, int wheel, double directions[2][2])
{
    return evl_gearbox_support_directions(model->gearbox, wheel, directions[0]);
}

law_choice model_damping(const model *model, int mesh)
{
    evl_law_choice law;
    law_choice choice;
    evl_gearbox_damping(model->gearbox, mesh, &law);
    choice.law = law.law;
    memcpy(choice.parameters, law.parameters, sizeof choice.parameters);
    return choice;
}

void model_delete(model **pointer)
{
    model *model = *pointer;
    *pointer = NULL;
    if (model == NULL) {
        return;
    }
    evl_gearbox_delete(&model->gearbox);
    free((void *)model->dae.scale);
    free((void *)model->dae.row_scale);
    free((void *)model->dae.differential);
    free((void *)model->initial.speeds);
    free((void *)model->initial.gaps);
    for (int i = 0; model->mesh_names != NULL && i < model->sizes.n_meshes; i++) {
        free(model->mesh_names[i]);
    }
    free(model->mesh_names);
    free(model->wheel_of_load);
    free(model->load_of_load);
    free(model->outputs);
    free(model);
}

const dae *model_dae(const model *model)
{
    return &model->dae;
}

void model_explain_no_stepper(const model *model, model_message *error)
{
    evl_status status;
    (void)evl_radau_serves(model->gearbox, &status);
    explain(model, &status, error);
}

dae_state model_create_state(const model *model)
{
    const evl_sizes *sizes = &model->sizes;
    return (dae_state){.y = xcalloc((size_t)sizes->n_states, sizeof(double)),
                       .yp = xcalloc((size_t)sizes->n_states, sizeof(double)),
                       .integers = xcalloc((size_t)sizes->n_integers, sizeof(int)),
                       .reals = xcalloc((size_t)sizes->n_reals, sizeof(double))};
}

void model_explain_start(const model *model, const evl_status *status, model_message *error)
{
    explain(model, status, error);
    if (error->subject == MODEL_ABOUT_NOTHING) {
        error->subject = MODEL_ABOUT_INITIAL;
    }
}

static bool start(const model *model, const evl_initial *initial, dae_state *state, model_message *error)
{
    *state = model_create_state(model);
    evl_status status = {.index = -1};
    const int code = evl_gearbox_initial_state(model->gearbox, initial, state->t, state->y, state->yp, state->integers,
                                               state->reals, &status);
    if (code != EVL_OK) {
        model_explain_start(model, &status, error);
        dae_state_free(state);
    }
    return code == EVL_OK;
}

bool model_initial_state(const model *model, dae_state *state, model_message *error)
{
    return start(model, &model->initial, state, error);
}

bool model_steady_state(const model *model, double mesh_position, dae_state *state, model_message *error)
{
    const evl_initial steady = {.kind = EVL_INITIAL_STEADY, .mesh_position = mesh_position};
    return start(model, &steady, state, error);
}

void dae_state_free(dae_state *state)
{
    free(state->y);
    free(state->yp);
    free(state->integers);
    free(state->reals);
    *state = (dae_state){0};
}

int model_n_warnings(const model *model)
{
    evl_status status;
    return model->sizes.n_warnings + evl_gearbox_speed_warning(model->gearbox, &model->initial, &status);
}

void model_warning(const model *model, int index, model_message *warning)
{
    evl_status status;
    if (!evl_gearbox_warning(model->gearbox, index, &status)) {
        (void)evl_gearbox_speed_warning(model->gearbox, &model->initial, &status);
    }
    explain(model, &status, warning);
}
