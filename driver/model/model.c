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
        {"support_kind", "support.kind"},
        {"support_direction", "support.direction"},
        {"support_mass", "support.mass"},
        {"support_stiffness", "support.stiffness"},
        {"support_damping", "support.damping"},
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

static evl_gear translate_gear(const gear_description *gear)
{
    return (evl_gear){
        .normal_module = gear->module,
        .pressure_angle = gear->pressure_angle,
        .profile_shift = gear->profile_shift,
        .rack_addendum = gear->rack_addendum,
        .rack_dedendum = gear->rack_dedendum,
        .rack_root_radius = gear->rack_root_radius,
        .has_tip_diameter = gear->tip_diameter.given,
        .tip_diameter = gear->tip_diameter.value,
        .has_tip_alteration = gear->tip_alteration.given,
        .tip_alteration = gear->tip_alteration.value,
        .thickness_allowance = gear->thickness_allowance,
        .bore = gear->bore,
    };
}

static evl_relief translate_relief(const relief_description *relief)
{
    return (evl_relief){.amount = relief->amount,
                        .by_roll_angle = relief->by_roll_angle,
                        .start = relief->start,
                        .shape = relief->is_parabolic ? EVL_RELIEF_PARABOLIC : EVL_RELIEF_LINEAR};
}

static evl_flank_deviation translate_deviation(const deviation_description *deviation)
{
    return (evl_flank_deviation){
        .tip_relief = translate_relief(&deviation->tip_relief),
        .root_relief = translate_relief(&deviation->root_relief),
        .profile_crowning = deviation->profile_crowning,
        .n_pitch_errors = deviation->n_pitch_errors,
        .pitch_errors = deviation->pitch_errors,
        .accuracy_class = deviation->accuracy_class,
        .seed = deviation->seed,
        .runout_amount = deviation->runout_amount,
        .runout_phase = deviation->runout_phase,
    };
}

static evl_wheel translate_wheel(const description *description, const wheel_description *wheel)
{
    const material_description *material = &description->materials[wheel->material];
    const support_description *support = &wheel->support;
    static const int kinds[] = {
        [SUPPORT_FIXED] = EVL_SUPPORT_FIXED,
        [SUPPORT_SLIDER] = EVL_SUPPORT_SLIDER,
        [SUPPORT_BEARING] = EVL_SUPPORT_BEARING,
    };
    return (evl_wheel){
        .teeth = wheel->teeth,
        .has_pitch_radius = wheel->pitch_radius.given,
        .pitch_radius = wheel->pitch_radius.value,
        .width = wheel->width,
        .has_centre = wheel->has_centre,
        .centre = {wheel->centre[0], wheel->centre[1]},
        .youngs_modulus = material->youngs_modulus,
        .poisson_ratio = material->poisson_ratio,
        .density = material->density,
        .has_inertia = wheel->inertia.given,
        .inertia = wheel->inertia.value,
        .has_mass = wheel->mass.given,
        .mass = wheel->mass.value,
        .support_kind = kinds[support->kind],
        .support_direction = support->direction,
        .support_mass = support->mass,
        .support_stiffness = {support->stiffness[0], support->stiffness[1]},
        .support_damping = {support->damping[0], support->damping[1]},
        .has_transverse_inertia = wheel->transverse_inertia.given,
        .transverse_inertia = wheel->transverse_inertia.value,
        .axial_position = wheel->axial_position,
        .has_gear = wheel->has_gear,
        .gear = translate_gear(&wheel->gear),
        .deviation = translate_deviation(&wheel->deviation),
    };
}

static evl_load translate_load(int wheel, const load_description *load)
{
    static const int kinds[] = {
        [LOAD_TORQUE] = EVL_LOAD_TORQUE,
        [LOAD_VISCOUS] = EVL_LOAD_VISCOUS,
        [LOAD_TABLE] = EVL_LOAD_TABLE,
        [LOAD_SPEED] = EVL_LOAD_SPEED,
    };
    return (evl_load){.wheel = wheel,
                      .kind = kinds[load->kind],
                      .value = load->value,
                      .n = load->n,
                      .time = load->time,
                      .values = load->values,
                      .against_housing = load->against_housing};
}

static evl_law_choice translate_law(const law_choice *choice)
{
    evl_law_choice law = {.law = choice->law};
    memcpy(law.parameters, choice->parameters, sizeof law.parameters);
    return law;
}

static evl_mesh translate_mesh(const mesh_description *mesh)
{
    static const int trackings[] = {
        [TRACKING_CLOSED_FORM] = EVL_TRACKING_CLOSED_FORM,
        [TRACKING_ALGEBRAIC] = EVL_TRACKING_ALGEBRAIC,
        [TRACKING_DIFFERENTIAL] = EVL_TRACKING_DIFFERENTIAL,
    };
    return (evl_mesh){
        .driving = mesh->driving,
        .driven = mesh->driven,
        .driving_rotation = mesh->driving_rotation,
        .has_centre_line_angle = mesh->centre_line_angle.given,
        .centre_line_angle = mesh->centre_line_angle.value,
        .paper_rule = mesh->paper_rule,
        .pressure_angle = mesh->pressure_angle,
        .contact = translate_law(&mesh->contact),
        .damping = translate_law(&mesh->damping),
        .friction = translate_law(&mesh->friction),
        .tracking = trackings[mesh->tracking],
        .has_centre_distance = mesh->centre_distance.given,
        .centre_distance = mesh->centre_distance.value,
        .has_backlash = mesh->backlash.given,
        .backlash = mesh->backlash.value,
    };
}

static evl_shaft translate_shaft(const shaft_description *shaft)
{
    return (evl_shaft){.wheel_a = shaft->wheels[0],
                       .wheel_b = shaft->wheels[1],
                       .rigid = shaft->rigid,
                       .stiffness = shaft->stiffness,
                       .damping = shaft->damping};
}

static double *copy_doubles(const double *from, int n)
{
    if (from == NULL) {
        return NULL;
    }
    double *copy = xcalloc((size_t)n, sizeof *copy);
    return memcpy(copy, from, (size_t)n * sizeof *copy);
}

static evl_initial translate_initial(const description *description)
{
    const initial_description *initial = &description->simulation.initial;
    static const int kinds[] = {
        [INITIAL_REST] = EVL_INITIAL_REST,
        [INITIAL_STEADY] = EVL_INITIAL_STEADY,
        [INITIAL_SPEEDS] = EVL_INITIAL_SPEEDS,
    };
    const bool has_gaps = initial->kind != INITIAL_STEADY;
    return (evl_initial){.kind = kinds[initial->kind],
                         .speeds = copy_doubles(initial->speeds, description->n_wheels),
                         .gaps = has_gaps ? copy_doubles(initial->gaps, description->n_meshes) : NULL};
}

static int count_loads(const description *description)
{
    int n = 0;
    for (int i = 0; i < description->n_wheels; i++) {
        n += description->wheels[i].n_loads;
    }
    return n;
}

static evl_gearbox *create_gearbox(model *model, const description *description, evl_status *status)
{
    const int n_loads = count_loads(description);
    evl_wheel *wheels = xcalloc((size_t)description->n_wheels, sizeof *wheels);
    evl_load *loads = xcalloc((size_t)n_loads, sizeof *loads);
    evl_mesh *meshes = xcalloc((size_t)description->n_meshes, sizeof *meshes);
    evl_shaft *shafts = xcalloc((size_t)description->n_shafts, sizeof *shafts);
    model->wheel_of_load = xcalloc((size_t)n_loads, sizeof *model->wheel_of_load);
    model->load_of_load = xcalloc((size_t)n_loads, sizeof *model->load_of_load);
    int k = 0;
    for (int i = 0; i < description->n_wheels; i++) {
        const wheel_description *wheel = &description->wheels[i];
        wheels[i] = translate_wheel(description, wheel);
        for (int j = 0; j < wheel->n_loads; j++, k++) {
            loads[k] = translate_load(i, &wheel->loads[j]);
            model->wheel_of_load[k] = i;
            model->load_of_load[k] = j;
        }
    }
    for (int i = 0; i < description->n_meshes; i++) {
        meshes[i] = translate_mesh(&description->meshes[i]);
    }
    for (int i = 0; i < description->n_shafts; i++) {
        shafts[i] = translate_shaft(&description->shafts[i]);
    }
    evl_motion_term *terms = model_translate_motion(&description->housing);
    const evl_housing housing = model_translate_housing(description, terms);
    evl_gearbox *gearbox = evl_gearbox_create(description->n_wheels, wheels, n_loads, loads, description->n_meshes,
                                              meshes, description->n_shafts, shafts, &housing, status);
    free(terms);
    free(shafts);
    free(meshes);
    free(loads);
    free(wheels);
    return gearbox;
}

model *model_create(const description *description, model_message *error)
{
    evl_status status = {.index = -1};
    model *model = xcalloc(1, sizeof *model);
    model->initial = translate_initial(description);
    model->gearbox = create_gearbox(model, description, &status);
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
