#include "base/memory.h"
#include "model/model_kernel.h"

#include <string.h>

static evl_motion_term translate_term(const motion_description *motion)
{
    static const int kinds[] = {
        [MOTION_CONSTANT] = EVL_MOTION_CONSTANT,
        [MOTION_RATE] = EVL_MOTION_RATE,
        [MOTION_HARMONIC] = EVL_MOTION_HARMONIC,
        [MOTION_TABLE] = EVL_MOTION_TABLE,
    };
    return (evl_motion_term){.coordinate = motion->coordinate,
                             .kind = kinds[motion->kind],
                             .value = motion->value,
                             .frequency = motion->frequency,
                             .phase = motion->phase,
                             .n = motion->n,
                             .time = motion->time,
                             .values = motion->values};
}

evl_motion_term *model_translate_motion(const housing_description *housing)
{
    evl_motion_term *terms = xcalloc((size_t)housing->n_motions, sizeof *terms);
    for (int i = 0; i < housing->n_motions; i++) {
        terms[i] = translate_term(&housing->motions[i]);
    }
    return terms;
}

evl_housing model_translate_housing(const description *description, const evl_motion_term *terms)
{
    static const int kinds[] = {
        [HOUSING_FIXED] = EVL_HOUSING_FIXED,
        [HOUSING_PRESCRIBED] = EVL_HOUSING_PRESCRIBED,
        [HOUSING_MOUNTED] = EVL_HOUSING_MOUNTED,
    };
    const housing_description *from = &description->housing;
    evl_housing to = {.kind = kinds[from->kind], .n_terms = from->n_motions, .terms = terms, .mass = from->mass};
    memcpy(to.gravity, description->gravity, sizeof to.gravity);
    memcpy(to.centre_of_mass, from->centre_of_mass, sizeof to.centre_of_mass);
    memcpy(to.inertia, from->inertia, sizeof to.inertia);
    memcpy(to.products_of_inertia, from->products_of_inertia, sizeof to.products_of_inertia);
    memcpy(to.mount_point, from->mount_point, sizeof to.mount_point);
    memcpy(to.stiffness, from->stiffness, sizeof to.stiffness);
    memcpy(to.damping, from->damping, sizeof to.damping);
    memcpy(to.rotational_stiffness, from->rotational_stiffness, sizeof to.rotational_stiffness);
    memcpy(to.rotational_damping, from->rotational_damping, sizeof to.rotational_damping);
    memcpy(to.force, from->force, sizeof to.force);
    memcpy(to.moment, from->moment, sizeof to.moment);
    memcpy(to.position, from->position, sizeof to.position);
    memcpy(to.orientation, from->orientation, sizeof to.orientation);
    memcpy(to.velocity, from->velocity, sizeof to.velocity);
    memcpy(to.angular_velocity, from->angular_velocity, sizeof to.angular_velocity);
    return to;
}
