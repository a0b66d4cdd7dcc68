#include "case/case_resolve.h"

#include "base/memory.h"
#include "base/suggest.h"
#include "case/case_check.h"
#include "case/case_deviation.h"
#include "case/case_housing.h"
#include "case/case_loads.h"
#include "case/case_names.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* more rows than that is a slip of the keyboard, not a history */
static const double MOST_OUTPUTS = 1e9;

static const double RADIANS_PER_DEGREE = 0.017453292519943295769;

/* ---- values that the schema has checked ---- */

static optional_double get_optional(const case_node *block, const char *key)
{
    const case_node *node = node_get(block, key);
    return node == NULL ? (optional_double){0} : (optional_double){.given = true, .value = node_number(node)};
}

static void get_pair(const case_node *block, const char *key, double pair[2])
{
    const case_node *node = node_get(block, key);
    pair[0] = node_number(node->entries[0].value);
    pair[1] = node_number(node->entries[1].value);
}

/* ---- parts of the description ---- */

static void resolve_materials(const case_node *node, description *to)
{
    to->materials = xcalloc((size_t)node->n, sizeof *to->materials);
    to->n_materials = node->n;
    for (int i = 0; i < node->n; i++) {
        const case_node *block = node->entries[i].value;
        to->materials[i] = (material_description){.name = xstrdup(node->entries[i].key),
                                                  .youngs_modulus = node_get_number(block, "youngs_modulus"),
                                                  .poisson_ratio = node_get_number(block, "poisson_ratio"),
                                                  .density = node_get_number(block, "density")};
    }
}

/** The keys that stand beside `module`. */
static gear_description resolve_gear(const case_node *block)
{
    const case_node *rack = node_get(block, "rack");
    return (gear_description){
        .module = node_get_number(block, "module"),
        .pressure_angle = node_get_number(block, "pressure_angle") * RADIANS_PER_DEGREE,
        .profile_shift = node_get_number(block, "profile_shift"),
        .rack_addendum = node_get_number(rack, "addendum"),
        .rack_dedendum = node_get_number(rack, "dedendum"),
        .rack_root_radius = node_get_number(rack, "root_radius"),
        .tip_diameter = get_optional(block, "tip_diameter"),
        .tip_alteration = get_optional(block, "tip_alteration"),
        .thickness_allowance = node_get_number(block, "thickness_allowance"),
        .bore = node_get_number(block, "bore"),
    };
}

static bool resolve_wheel(checker *checker, const case_node *block, const case_node *materials, const law_tables *laws,
                          wheel_description *wheel)
{
    wheel->name = xstrdup(node_get_text(block, "name"));
    const bool is_disc = node_get(block, "teeth") == NULL;
    const case_node *other = node_get(block, is_disc ? "pitch_radius" : "radius");
    if (is_disc && other == NULL) {
        other = node_get(block, "module");
    }
    if (other != NULL) {
        return is_disc ? checker_refuse(
                             checker, other->place,
                             "a wheel without teeth has no pitch radius and no module; give 'radius', or 'teeth'")
                       : checker_refuse(checker, other->place,
                                        "'radius' is that of a disc without teeth; give 'pitch_radius'");
    }
    wheel->teeth = is_disc ? 0 : (int)node_get_number(block, "teeth");
    wheel->pitch_radius = get_optional(block, is_disc ? "radius" : "pitch_radius");
    wheel->has_gear = node_get(block, "module") != NULL;
    if (wheel->has_gear) {
        wheel->gear = resolve_gear(block);
    }
    if (!case_resolve_deviation(checker, block, &wheel->deviation)) {
        return false;
    }
    wheel->width = node_get_number(block, "width");
    wheel->has_centre = node_get(block, "centre") != NULL;
    if (wheel->has_centre) {
        get_pair(block, "centre", wheel->centre);
    }
    wheel->inertia = get_optional(block, "inertia");
    wheel->mass = get_optional(block, "mass");
    wheel->transverse_inertia = get_optional(block, "transverse_inertia");
    wheel->axial_position = node_get_number(block, "axial_position");
    return case_resolve_kind(checker, node_get(block, "support"), laws->n_supports, laws->supports, &wheel->support) &&
           case_find_reference(checker, block, "material", "material", materials, &wheel->material) &&
           case_resolve_loads(checker, node_get(block, "loads"), laws, wheel);
}

static law_choice resolve_law(const case_node *block, law_family family, const law_tables *laws)
{
    law_choice choice = {0};
    while (choice.law < laws->count[family] - 1 && !node_get_is(block, "law", laws->laws[family][choice.law].name)) {
        choice.law++;
    }
    const kind_info *law = &laws->laws[family][choice.law];
    for (int i = 0; i < law->n_parameters; i++) {
        const case_node *value = node_get(block, law->parameters[i].name);
        choice.parameters[i] = value == NULL ? NAN : node_number(value); /* left open to the model */
    }
    return choice;
}

/** The pressure angle states a pair of wheels without module; real gears have it from their centre distance. */
static bool resolve_pressure_angle(const checker *checker, const case_node *block, const case_node *wheels,
                                   mesh_description *mesh)
{
    const case_node *angle = node_get(block, "pressure_angle");
    const bool is_real = node_get(wheels->entries[mesh->driving].value, "module") != NULL &&
                         node_get(wheels->entries[mesh->driven].value, "module") != NULL;
    if (angle == NULL) {
        return is_real || checker_refuse(checker, block->place,
                                         "'pressure_angle' is missing (working pressure angle [deg] or paper_rule), or "
                                         "else the 'module' of both wheels");
    }
    mesh->paper_rule = node_get_is(block, "pressure_angle", "paper_rule");
    mesh->pressure_angle = mesh->paper_rule ? 0 : node_number(angle) * RADIANS_PER_DEGREE;
    return true;
}

static bool resolve_mesh(checker *checker, const case_node *block, const case_node *wheels, const law_tables *laws,
                         mesh_description *mesh)
{
    static const char *const trackings[] = {[TRACKING_CLOSED_FORM] = "closed_form",
                                            [TRACKING_ALGEBRAIC] = "algebraic",
                                            [TRACKING_DIFFERENTIAL] = "differential"};
    mesh->name = xstrdup(node_get_text(block, "name"));
    mesh->driving_rotation = node_get_is(block, "driving_rotation", "clockwise") ? -1 : 1;
    mesh->centre_line_angle = get_optional(block, "centre_line_angle");
    mesh->centre_line_angle.value *= RADIANS_PER_DEGREE;
    mesh->centre_distance = get_optional(block, "centre_distance");
    mesh->backlash = get_optional(block, "backlash");
    mesh->contact = resolve_law(node_get(block, "contact"), LAWS_CONTACT, laws);
    mesh->damping = resolve_law(node_get(block, "damping"), LAWS_DAMPING, laws);
    mesh->friction = resolve_law(node_get(block, "friction"), LAWS_FRICTION, laws);
    mesh->tracking = (tracking_kind)node_get_choice(block, "tracking", 3, trackings);
    if (!case_find_reference(checker, block, "driving", "wheel", wheels, &mesh->driving) ||
        !case_find_reference(checker, block, "driven", "wheel", wheels, &mesh->driven)) {
        return false;
    }
    if (mesh->driving == mesh->driven) {
        return checker_refuse(checker, node_get(block, "driven")->place, "the wheel '%s' cannot mesh with itself",
                              node_get_text(block, "driven"));
    }
    return resolve_pressure_angle(checker, block, wheels, mesh);
}

static bool resolve_shaft(checker *checker, const case_node *block, const case_node *wheels, shaft_description *shaft)
{
    const case_node *names = node_get(block, "wheels");
    shaft->name = xstrdup(node_get_text(block, "name"));
    shaft->rigid = node_get_is(block, "kind", "rigid");
    if (!shaft->rigid) {
        shaft->stiffness = node_get_number(block, "stiffness");
        shaft->damping = node_get_number(block, "damping");
    }
    for (int i = 0; i < 2; i++) {
        if (!case_find_name(checker, names->entries[i].value, "wheels", "wheel", wheels, &shaft->wheels[i])) {
            return false;
        }
    }
    return shaft->wheels[0] != shaft->wheels[1] ||
           checker_refuse(checker, names->place, "a shaft joins two different wheels");
}

/** Numbers by name, into the order of `among`. */
static bool resolve_named(checker *checker, const case_node *numbers, const char *what, const case_node *among,
                          double *values)
{
    const char **names = case_names(among);
    bool good = true;
    for (int i = 0; i < numbers->n && good; i++) {
        const case_entry *entry = &numbers->entries[i];
        const int index = case_name_index(entry->key, among->n, names);
        if (index >= 0) {
            values[index] = node_number(entry->value);
        } else {
            char *hint = suggest_phrase(entry->key, among->n, names);
            good = checker_refuse(checker, entry->key_place, "there is no %s '%.64s'%s", what, entry->key, hint);
            free(hint);
        }
    }
    free(names);
    return good;
}

static bool resolve_initial(checker *checker, const case_node *root, case_node *block, initial_description *initial)
{
    static const char *const kinds[] = {
        [INITIAL_REST] = "rest", [INITIAL_STEADY] = "steady", [INITIAL_SPEEDS] = "speeds"};
    const case_node *wheels = node_get(root, "wheels"), *meshes = node_get(root, "meshes");
    initial->kind = (initial_kind)node_get_choice(block, "kind", 3, kinds);
    initial->gaps = xcalloc((size_t)meshes->n, sizeof *initial->gaps);
    if (initial->kind == INITIAL_SPEEDS) {
        const case_node *speeds = node_get(block, "speeds");
        const size_t above = checker_enter(checker, "speeds");
        initial->speeds = xcalloc((size_t)wheels->n, sizeof *initial->speeds);
        if (!resolve_named(checker, speeds, "wheel", wheels, initial->speeds)) {
            return false;
        }
        for (int i = 0; i < wheels->n; i++) {
            const char *name = node_get_text(wheels->entries[i].value, "name");
            if (node_get(speeds, name) == NULL) {
                return checker_refuse(checker, speeds->place, "the speed of wheel '%s' is missing", name);
            }
        }
        checker_leave(checker, above);
    }
    case_node *gaps = node_get(block, "gaps");
    if (gaps != NULL) {
        const size_t above = checker_enter(checker, "gaps");
        if (!resolve_named(checker, gaps, "mesh", meshes, initial->gaps)) {
            return false;
        }
        checker_leave(checker, above);
        for (int i = 0; i < meshes->n; i++) {
            const char *name = node_get_text(meshes->entries[i].value, "name");
            if (node_get(gaps, name) == NULL) {
                node_append(gaps, name, gaps->place, node_create_scalar("0", true, gaps->place));
            }
        }
    }
    return true;
}

static integrator_kind resolve_integrator(const case_node *block)
{
    if (node_get(block, "integrator") == NULL) {
        return INTEGRATOR_OPEN;
    }
    return node_get_is(block, "integrator", "radau") ? INTEGRATOR_RADAU : INTEGRATOR_IDA;
}

static bool resolve_simulation(checker *checker, case_node *root, simulation_description *simulation)
{
    const case_node *block = node_get(root, "simulation"), *interval = node_get(block, "output_interval");
    simulation->duration = node_get_number(block, "duration");
    simulation->output_interval = node_number(interval);
    simulation->tolerance = node_get_number(block, "tolerance");
    simulation->integrator = resolve_integrator(block);
    simulation->max_step = node_get_number(block, "max_step");
    size_t above = checker_enter(checker, "simulation");
    const size_t block_label = above;
    if (simulation->output_interval > simulation->duration ||
        simulation->duration / simulation->output_interval > MOST_OUTPUTS) {
        const bool is_longer = simulation->output_interval > simulation->duration;
        (void)checker_enter(checker, "output_interval");
        return is_longer ? checker_refuse(checker, interval->place, "is %s s, longer than the duration of %s s",
                                          interval->text, node_get_text(block, "duration"))
                         : checker_refuse(checker, interval->place,
                                          "is %s s, which gives more than %g rows in %s s; take a longer one",
                                          interval->text, MOST_OUTPUTS, node_get_text(block, "duration"));
    }
    if (simulation->integrator == INTEGRATOR_RADAU && simulation->tolerance < RADAU_SMALLEST_TOLERANCE) {
        (void)checker_enter(checker, "tolerance");
        return checker_refuse(checker, node_get(block, "tolerance")->place,
                              "is %s, but integrator radau takes %g or more; take integrator ida for less",
                              node_get_text(block, "tolerance"), RADAU_SMALLEST_TOLERANCE);
    }
    above = checker_enter(checker, "initial");
    if (!resolve_initial(checker, root, node_get(block, "initial"), &simulation->initial)) {
        return false;
    }
    checker_leave(checker, above);
    checker_leave(checker, block_label);
    return true;
}

bool case_resolve(const char *path, case_node *root, const law_tables *laws, description *description, evl_error *error)
{
    checker checker = {.path = path, .error = error};
    const case_node *materials = node_get(root, "materials"), *wheels = node_get(root, "wheels");
    const case_node *meshes = node_get(root, "meshes"), *shafts = node_get(root, "shafts");
    description->title = xstrdup(node_get_text(root, "title"));
    resolve_materials(materials, description);
    if (!case_check_unique(&checker, wheels, "wheel", "wheels") ||
        !case_check_unique(&checker, meshes, "mesh", "meshes") ||
        !case_check_unique(&checker, shafts, "shaft", "shafts")) {
        return false;
    }
    description->wheels = xcalloc((size_t)wheels->n, sizeof *description->wheels);
    description->n_wheels = wheels->n;
    for (int i = 0; i < wheels->n; i++) {
        const case_node *block = wheels->entries[i].value;
        (void)checker_enter(&checker, "wheels");
        (void)checker_enter(&checker, node_get_text(block, "name"));
        if (!resolve_wheel(&checker, block, materials, laws, &description->wheels[i])) {
            return false;
        }
        checker_leave(&checker, 0);
    }
    description->meshes = xcalloc((size_t)meshes->n, sizeof *description->meshes);
    description->n_meshes = meshes->n;
    for (int i = 0; i < meshes->n; i++) {
        const case_node *block = meshes->entries[i].value;
        (void)checker_enter(&checker, "meshes");
        (void)checker_enter(&checker, node_get_text(block, "name"));
        if (!resolve_mesh(&checker, block, wheels, laws, &description->meshes[i])) {
            return false;
        }
        checker_leave(&checker, 0);
    }
    description->shafts = xcalloc((size_t)shafts->n, sizeof *description->shafts);
    description->n_shafts = shafts->n;
    for (int i = 0; i < shafts->n; i++) {
        const case_node *block = shafts->entries[i].value;
        (void)checker_enter(&checker, "shafts");
        (void)checker_enter(&checker, node_get_text(block, "name"));
        if (!resolve_shaft(&checker, block, wheels, &description->shafts[i])) {
            return false;
        }
        checker_leave(&checker, 0);
    }
    return case_resolve_housing(&checker, root, description) &&
           resolve_simulation(&checker, root, &description->simulation);
}
