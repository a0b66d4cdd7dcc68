/* A description in the kernel's own structures. */
#include "base/memory.h"
#include "model/model_kernel.h"

#include <stdlib.h>
#include <string.h>

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

static evl_support translate_support(const kind_choice *support)
{
    evl_support to = {.kind = support->kind, .numbers = support->numbers};
    memcpy(to.counts, support->counts, sizeof to.counts);
    return to;
}

static evl_wheel translate_wheel(const description *description, const wheel_description *wheel)
{
    const material_description *material = &description->materials[wheel->material];
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
        .support = translate_support(&wheel->support),
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
    evl_load to = {.wheel = wheel,
                   .kind = load->choice.kind,
                   .against_housing = load->against_housing,
                   .numbers = load->choice.numbers};
    memcpy(to.counts, load->choice.counts, sizeof to.counts);
    return to;
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

evl_initial model_translate_initial(const description *description)
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

evl_gearbox *model_create_gearbox(model *model, const description *description, evl_status *status)
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
