#include "case/case_housing.h"

#include "base/memory.h"
#include "case/case_loads.h"

#include <stdio.h>

static const double RADIANS_PER_DEGREE = 0.017453292519943295769;

static void get_components(const case_node *block, const char *key, int n, double *values)
{
    const case_node *node = node_get(block, key);
    for (int i = 0; i < n; i++) {
        values[i] = node_number(node->entries[i].value);
    }
}

/** One term; amplitudes, constants and tables of angles are in degrees, rates are in rad/s. */
static bool resolve_term(checker *checker, const case_node *block, bool is_rotation, motion_description *motion)
{
    static const char *const kinds[] = {[MOTION_CONSTANT] = "constant",
                                        [MOTION_RATE] = "rate",
                                        [MOTION_HARMONIC] = "harmonic",
                                        [MOTION_TABLE] = "table"};
    static const char *const axes[] = {"x", "y", "z"};
    const double unit = is_rotation ? RADIANS_PER_DEGREE : 1.0;
    motion->kind = (motion_kind)node_get_choice(block, "kind", 4, kinds);
    motion->coordinate = node_get_choice(block, "axis", 3, axes) + (is_rotation ? 3 : 0);
    switch (motion->kind) {
    case MOTION_CONSTANT:
        motion->value = node_get_number(block, "value") * unit;
        return true;
    case MOTION_RATE:
        motion->value = node_get_number(block, "value");
        return true;
    case MOTION_HARMONIC:
        motion->value = node_get_number(block, "amplitude") * unit;
        motion->frequency = node_get_number(block, "frequency");
        motion->phase = node_get_number(block, "phase") * RADIANS_PER_DEGREE;
        return true;
    case MOTION_TABLE:
        break;
    }
    case_table table = {0};
    const bool good = case_resolve_table(checker, block, "value", &table);
    motion->n = table.n;
    motion->time = table.time;
    motion->values = table.values;
    for (int i = 0; i < motion->n; i++) {
        motion->values[i] *= unit;
    }
    return good;
}

static bool resolve_terms(checker *checker, const case_node *block, const char *key, housing_description *housing)
{
    const case_node *list = node_get(block, key);
    const bool is_rotation = key[0] == 'r';
    for (int i = 0; i < list->n; i++) {
        char step[32];
        (void)snprintf(step, sizeof step, "%s.%d", key, i);
        const size_t above = checker_enter(checker, step);
        if (!resolve_term(checker, list->entries[i].value, is_rotation, &housing->motions[housing->n_motions++])) {
            return false;
        }
        checker_leave(checker, above);
    }
    return true;
}

static bool resolve_motion(checker *checker, const case_node *block, housing_description *housing)
{
    const int n = node_get(block, "translation")->n + node_get(block, "rotation")->n;
    housing->motions = xcalloc((size_t)n, sizeof *housing->motions);
    const size_t above = checker_enter(checker, "housing");
    if (!resolve_terms(checker, block, "translation", housing) || !resolve_terms(checker, block, "rotation", housing)) {
        return false;
    }
    checker_leave(checker, above);
    return true;
}

static void resolve_body(const case_node *block, housing_description *housing)
{
    const case_node *mount = node_get(block, "mount");
    housing->mass = node_get_number(block, "mass");
    get_components(block, "centre_of_mass", 3, housing->centre_of_mass);
    get_components(block, "inertia", 3, housing->inertia);
    get_components(block, "products_of_inertia", 3, housing->products_of_inertia);
    get_components(mount, "point", 3, housing->mount_point);
    get_components(mount, "stiffness", 3, housing->stiffness);
    get_components(mount, "damping", 3, housing->damping);
    get_components(mount, "rotational_stiffness", 3, housing->rotational_stiffness);
    get_components(mount, "rotational_damping", 3, housing->rotational_damping);
    get_components(block, "force", 3, housing->force);
    get_components(block, "moment", 3, housing->moment);
    get_components(block, "position", 3, housing->position);
    get_components(block, "orientation", 4, housing->orientation);
    get_components(block, "velocity", 3, housing->velocity);
    get_components(block, "angular_velocity", 3, housing->angular_velocity);
}

bool case_resolve_housing(checker *checker, const case_node *root, description *description)
{
    static const char *const kinds[] = {
        [HOUSING_FIXED] = "fixed", [HOUSING_PRESCRIBED] = "prescribed", [HOUSING_MOUNTED] = "mounted"};
    const case_node *block = node_get(root, "housing");
    housing_description *housing = &description->housing;
    get_components(root, "gravity", 3, description->gravity);
    housing->kind = (housing_kind)node_get_choice(block, "kind", 3, kinds);
    if (housing->kind == HOUSING_MOUNTED) {
        resolve_body(block, housing);
    }
    return housing->kind != HOUSING_PRESCRIBED || resolve_motion(checker, block, housing);
}
