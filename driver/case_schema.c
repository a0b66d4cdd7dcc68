/* The table of all keys. */
#include "case_schema.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "memory.h"
#include "number.h"

/* clang-format off */
#define ANY -HUGE_VAL, HUGE_VAL, false, false
#define POSITIVE 0, HUGE_VAL, true, false
#define NOT_NEGATIVE 0, HUGE_VAL, false, false
#define AT_LEAST(n) (n), HUGE_VAL, false, false
#define BETWEEN(a, b) (a), (b), false, false
#define REQUIRED true, NULL
#define OPTIONAL false, NULL
#define DEFAULT(text) false, text

static const case_key fixed_keys[] = {
    /* block, variants, key, type, unit, range, required or default, words, block it holds, meaning */
    {CASE_ROOT, "", "format", KEY_INTEGER, "", ANY, REQUIRED, "", "", "version of this format: 1"},
    {CASE_ROOT, "", "title", KEY_TEXT, "", ANY, DEFAULT("''"), "", "",
     "what the case is about; becomes the title of the history"},
    {CASE_ROOT, "", "materials", KEY_MAP, "", AT_LEAST(1), REQUIRED, "", "material", "the materials by name"},
    {CASE_ROOT, "", "wheels", KEY_LIST, "", AT_LEAST(2), REQUIRED, "", "wheel",
     "the wheels; the order is that of the history"},
    {CASE_ROOT, "", "meshes", KEY_LIST, "", AT_LEAST(1), REQUIRED, "", "mesh", "which wheels mesh, and how"},
    {CASE_ROOT, "", "shafts", KEY_LIST, "", AT_LEAST(0), DEFAULT("[]"), "", "shaft",
     "which wheels on one axis turn together"},
    {CASE_ROOT, "", "gravity", KEY_TRIPLE, "m/s2", ANY, DEFAULT("[0, 0, 0]"), "", "", "gravity in the ground frame"},
    {CASE_ROOT, "", "housing", KEY_BLOCK, "", ANY, DEFAULT("{kind: fixed}"), "", "housing", "how the housing moves"},
    {CASE_ROOT, "", "simulation", KEY_BLOCK, "", ANY, REQUIRED, "", "simulation", "what to compute"},

    {"material", "", "youngs_modulus", KEY_NUMBER, "Pa", POSITIVE, REQUIRED, "", "", "Young's modulus E"},
    {"material", "", "poisson_ratio", KEY_NUMBER, "", 0, 0.5, false, true, REQUIRED, "", "", "Poisson's ratio nu"},
    {"material", "", "density", KEY_NUMBER, "kg/m3", POSITIVE, REQUIRED, "", "",
     "density, for mass and inertia where they are not given"},

    {"wheel", "", "name", KEY_NAME, "", ANY, REQUIRED, "", "", "name in references, paths and the history"},
    {"wheel", "", "teeth", KEY_INTEGER, "", BETWEEN(3, 10000), OPTIONAL, "", "",
     "number of teeth z; a wheel without teeth is a disc on a shaft"},
    {"wheel", "", "pitch_radius", KEY_NUMBER, "m", POSITIVE, OPTIONAL, "", "",
     "pitch radius r; otherwise it follows from a mesh, or is half the reference diameter of a real gear"},
    {"wheel", "", "module", KEY_NUMBER, "m", POSITIVE, OPTIONAL, "", "",
     "normal module m_n: makes the wheel a real gear, ISO 21771; otherwise its radii follow from pitch_radius"},
    {"wheel", "+module", "pressure_angle", KEY_NUMBER, "deg", BETWEEN(5, 45), DEFAULT("20"), "", "",
     "pressure angle alpha_n of the basic rack"},
    {"wheel", "+module", "profile_shift", KEY_NUMBER, "", BETWEEN(-5, 5), DEFAULT("0"), "", "",
     "profile shift coefficient x, in modules"},
    {"wheel", "+module", "rack", KEY_BLOCK, "", ANY, DEFAULT("{}"), "", "rack", "basic rack, ISO 53"},
    {"wheel", "+module", "tip_diameter", KEY_NUMBER, "m", POSITIVE, OPTIONAL, "", "",
     "tip diameter d_a; otherwise from the rack, the profile shift and tip_alteration"},
    {"wheel", "+module", "tip_alteration", KEY_NUMBER, "", BETWEEN(-5, 5), OPTIONAL, "", "",
     "tip alteration coefficient k, in modules; 0 unless given"},
    {"wheel", "+module", "thickness_allowance", KEY_NUMBER, "m", -HUGE_VAL, 0, false, false, DEFAULT("0"), "", "",
     "change of the tooth thickness on the reference circle; negative: thinner teeth, backlash"},
    {"wheel", "+module", "bore", KEY_NUMBER, "m", NOT_NEGATIVE, DEFAULT("0"), "", "", "diameter of the bore"},
    {"wheel", "+module", "tip_relief", KEY_BLOCK, "", ANY, OPTIONAL, "", "relief",
     "material taken off towards the tip"},
    {"wheel", "+module", "root_relief", KEY_BLOCK, "", ANY, OPTIONAL, "", "relief",
     "material taken off towards the start of the active profile"},
    {"wheel", "+module", "profile_crowning", KEY_NUMBER, "m", NOT_NEGATIVE, DEFAULT("0"), "", "",
     "material taken off at both ends of the active profile, C_alpha; a parabola, 0 in the middle"},
    {"wheel", "+module", "pitch_errors", KEY_SERIES, "m", ANY, OPTIONAL, "", "",
     "cumulative position deviation of each tooth, arc on the reference circle, counterclockwise positive"},
    {"wheel", "+module", "accuracy", KEY_BLOCK, "", ANY, OPTIONAL, "", "accuracy",
     "pitch errors from a flank tolerance class, instead of pitch_errors"},
    {"wheel", "+module", "runout", KEY_BLOCK, "", ANY, OPTIONAL, "", "runout", "the teeth's centre lies off the axle"},
    {"wheel", "", "width", KEY_NUMBER, "m", POSITIVE, REQUIRED, "", "", "face width"},
    {"wheel", "", "centre", KEY_PAIR, "m", ANY, OPTIONAL, "", "",
     "reference position of the axle; otherwise it follows from a mesh"},
    {"wheel", "", "material", KEY_REFERENCE, "", ANY, REQUIRED, "", "", "name of its material"},
    {"wheel", "", "inertia", KEY_NUMBER, "kg m2", POSITIVE, OPTIONAL, "", "",
     "moment of inertia about the axle; otherwise that of a disc of the pitch radius, less its bore"},
    {"wheel", "", "mass", KEY_NUMBER, "kg", POSITIVE, OPTIONAL, "", "",
     "mass; otherwise that of a disc of the pitch radius, less its bore"},
    {"wheel", "", "transverse_inertia", KEY_NUMBER, "kg m2", POSITIVE, OPTIONAL, "", "",
     "moment of inertia about a diameter; otherwise that of a disc or ring of its mass and inertia"},
    {"wheel", "", "axial_position", KEY_NUMBER, "m", ANY, DEFAULT("0"), "", "",
     "z of the middle of the face; the faces of wheels in mesh have to overlap"},
    {"wheel", "", "support", KEY_BLOCK, "", ANY, DEFAULT("{kind: fixed}"), "", "support", "how the axle is held"},
    {"wheel", "", "loads", KEY_LIST, "", AT_LEAST(0), DEFAULT("[]"), "", "load",
     "what acts on the wheel; torques add up"},
    {"wheel", "", "radius", KEY_NUMBER, "m", POSITIVE, OPTIONAL, "", "",
     "radius of a disc, for mass and inertia where they are not given"},

    {"rack", "", "addendum", KEY_NUMBER, "", POSITIVE, DEFAULT("1"), "", "", "addendum h_aP, in modules"},
    {"rack", "", "dedendum", KEY_NUMBER, "", POSITIVE, DEFAULT("1.25"), "", "", "dedendum h_fP, in modules"},
    {"rack", "", "root_radius", KEY_NUMBER, "", NOT_NEGATIVE, DEFAULT("0.38"), "", "",
     "root fillet radius rho_fP, in modules"},

    {"relief", "", "amount", KEY_NUMBER, "m", NOT_NEGATIVE, REQUIRED, "", "",
     "material taken off at the end of the profile, along the normal"},
    {"relief", "", "diameter", KEY_NUMBER, "m", POSITIVE, OPTIONAL, "", "", "diameter at which it starts"},
    {"relief", "", "roll_angle", KEY_NUMBER, "deg", POSITIVE, OPTIONAL, "", "",
     "roll angle at which it starts; either this or diameter"},
    {"relief", "", "shape", KEY_CHOICE, "", ANY, DEFAULT("linear"), "linear parabolic", "",
     "over the roll angle; parabolic: without a kink at its start"},

    {"accuracy", "", "class", KEY_INTEGER, "", BETWEEN(1, 11), REQUIRED, "", "",
     "flank tolerance class, ISO 1328-1:2013"},
    {"accuracy", "", "seed", KEY_INTEGER, "", BETWEEN(0, 1000000000), DEFAULT("0"), "", "",
     "chooses the random numbers; the same for two wheels: the same numbers"},

    {"runout", "", "amount", KEY_NUMBER, "m", NOT_NEGATIVE, REQUIRED, "", "",
     "eccentricity e_c: about half of the measured radial runout"},
    {"runout", "", "phase", KEY_NUMBER, "deg", BETWEEN(-360, 360), DEFAULT("0"), "", "",
     "its direction from the middle of tooth 0, counterclockwise"},

    {"support", "", "kind", KEY_CHOICE, "", ANY, DEFAULT("fixed"), "fixed slider bearing", "",
     "fixed axle; slider: moves in one direction; bearing: moves in x and y"},
    {"support", "slider", "direction", KEY_NUMBER, "deg", BETWEEN(-360, 360), DEFAULT("0"), "", "",
     "angle of the direction to the x axis"},
    {"support", "slider bearing", "mass", KEY_NUMBER, "kg", NOT_NEGATIVE, DEFAULT("0"), "", "",
     "mass that moves with the axle, beside the wheel's own"},
    {"support", "slider", "stiffness", KEY_NUMBER, "N/m", NOT_NEGATIVE, REQUIRED, "", "", "stiffness of the spring"},
    {"support", "slider", "damping", KEY_NUMBER, "N s/m", NOT_NEGATIVE, DEFAULT("0"), "", "",
     "coefficient of the damper"},
    {"support", "bearing", "stiffness", KEY_PAIR, "N/m", NOT_NEGATIVE, REQUIRED, "", "", "stiffness in x and y"},
    {"support", "bearing", "damping", KEY_PAIR, "N s/m", NOT_NEGATIVE, DEFAULT("[0, 0]"), "", "", "damping in x and y"},

    {"load", "", "kind", KEY_CHOICE, "", ANY, REQUIRED, "torque viscous table speed", "",
     "constant torque; torque against the speed; torque over time; prescribed speed"},
    {"load", "", "against", KEY_CHOICE, "", ANY, DEFAULT("ground"), "ground housing", "",
     "where the reaction goes, and to what a speed refers"},
    {"load", "torque", "value", KEY_NUMBER, "N m", ANY, REQUIRED, "", "", "torque, counterclockwise positive"},
    {"load", "viscous", "coefficient", KEY_NUMBER, "N m s/rad", NOT_NEGATIVE, REQUIRED, "", "",
     "the torque is minus coefficient times angular velocity"},
    {"load", "table", "time", KEY_SERIES, "s", ANY, REQUIRED, "", "",
     "knots of the table, strictly increasing, at least two"},
    {"load", "table", "torque", KEY_SERIES, "N m", ANY, REQUIRED, "", "",
     "torque at the knots; linear between them, constant outside"},
    {"load", "speed", "value", KEY_NUMBER, "rad/s", ANY, OPTIONAL, "", "",
     "constant angular velocity; or else time and speed"},
    {"load", "speed", "time", KEY_SERIES, "s", ANY, OPTIONAL, "", "",
     "knots of the table, strictly increasing, at least two"},
    {"load", "speed", "speed", KEY_SERIES, "rad/s", ANY, OPTIONAL, "", "",
     "angular velocity at the knots; linear between them, constant outside"},

    {"mesh", "", "name", KEY_NAME, "", ANY, DEFAULT("{driving}-{driven}"), "", "", "name in paths and the history"},
    {"mesh", "", "driving", KEY_REFERENCE, "", ANY, REQUIRED, "", "", "name of the driving wheel"},
    {"mesh", "", "driven", KEY_REFERENCE, "", ANY, REQUIRED, "", "", "name of the driven wheel"},
    {"mesh", "", "driving_rotation", KEY_CHOICE, "", ANY, REQUIRED, "clockwise counterclockwise", "",
     "nominal sense of the driving wheel; selects the flank"},
    {"mesh", "", "centre_line_angle", KEY_NUMBER, "deg", BETWEEN(-360, 360), OPTIONAL, "", "",
     "direction from the driving to the driven axle; otherwise it follows from the centres"},
    {"mesh", "", "pressure_angle", KEY_NUMBER, "deg", 0, 90, true, true, OPTIONAL, "paper_rule", "",
     "working pressure angle between wheels without module; paper_rule: 1.05 times the smallest possible one"},
    {"mesh", "", "centre_distance", KEY_NUMBER, "m", POSITIVE, OPTIONAL, "", "",
     "centre distance a_w of two real gears; otherwise from backlash, or else from the profile shifts"},
    {"mesh", "", "backlash", KEY_NUMBER, "m", NOT_NEGATIVE, OPTIONAL, "", "",
     "normal backlash j_bn; gives two real gears their centre distance, other wheels a second flank"},
    {"mesh", "", "contact", KEY_BLOCK, "", ANY, DEFAULT("{law: johnson}"), "", "contact", "normal elastic force"},
    {"mesh", "", "damping", KEY_BLOCK, "", ANY, DEFAULT("{law: none}"), "", "damping", "normal viscous force"},
    {"mesh", "", "friction", KEY_BLOCK, "", ANY, DEFAULT("{law: none}"), "", "friction", "tangential force"},
    {"mesh", "", "tracking", KEY_CHOICE, "", ANY, DEFAULT("closed_form"), "closed_form algebraic differential", "",
     "how the points of contact are found"},

    {"shaft", "", "kind", KEY_CHOICE, "", ANY, DEFAULT("elastic"), "elastic rigid", "",
     "a torsion spring and damper; the wheels turn as one body"},
    {"shaft", "", "name", KEY_NAME, "", ANY, REQUIRED, "", "", "name in paths and the history"},
    {"shaft", "", "wheels", KEY_REFERENCES, "", ANY, REQUIRED, "", "",
     "names of the two wheels that it joins, on one axis"},
    {"shaft", "elastic", "stiffness", KEY_NUMBER, "N m/rad", POSITIVE, REQUIRED, "", "", "torsional stiffness"},
    {"shaft", "elastic", "damping", KEY_NUMBER, "N m s/rad", NOT_NEGATIVE, DEFAULT("0"), "", "", "torsional damping"},

    {"housing", "", "kind", KEY_CHOICE, "", ANY, DEFAULT("fixed"), "fixed prescribed mounted", "",
     "at rest; moves as given; a rigid body on a mount"},
    {"housing", "prescribed", "translation", KEY_LIST, "", AT_LEAST(0), DEFAULT("[]"), "", "translation",
     "position of the origin in the ground frame; terms add up"},
    {"housing", "prescribed", "rotation", KEY_LIST, "", AT_LEAST(0), DEFAULT("[]"), "", "rotation",
     "rotation vector from the ground to the housing frame; terms add up"},
    {"housing", "mounted", "mass", KEY_NUMBER, "kg", POSITIVE, REQUIRED, "", "", "mass without wheels and supports"},
    {"housing", "mounted", "centre_of_mass", KEY_TRIPLE, "m", ANY, DEFAULT("[0, 0, 0]"), "", "",
     "centre of mass in the housing frame"},
    {"housing", "mounted", "inertia", KEY_TRIPLE, "kg m2", POSITIVE, REQUIRED, "", "",
     "elements xx, yy, zz of the inertia tensor about the centre of mass, housing frame"},
    {"housing", "mounted", "products_of_inertia", KEY_TRIPLE, "kg m2", ANY, DEFAULT("[0, 0, 0]"), "", "",
     "elements xy, yz, xz of the tensor: minus the integral of xy dm, and so on"},
    {"housing", "mounted", "mount", KEY_BLOCK, "", ANY, DEFAULT("{}"), "", "mount", "springs and dampers to the ground"},
    {"housing", "mounted", "force", KEY_TRIPLE, "N", ANY, DEFAULT("[0, 0, 0]"), "", "",
     "constant force at the centre of mass, ground frame"},
    {"housing", "mounted", "moment", KEY_TRIPLE, "N m", ANY, DEFAULT("[0, 0, 0]"), "", "",
     "constant moment, ground frame"},
    {"housing", "mounted", "position", KEY_TRIPLE, "m", ANY, DEFAULT("[0, 0, 0]"), "", "",
     "position of the origin at the start, ground frame"},
    {"housing", "mounted", "orientation", KEY_QUATERNION, "", ANY, DEFAULT("[1, 0, 0, 0]"), "", "",
     "quaternion at the start, of any length but 0; it turns the ground frame into the housing frame"},
    {"housing", "mounted", "velocity", KEY_TRIPLE, "m/s", ANY, DEFAULT("[0, 0, 0]"), "", "",
     "velocity of the origin at the start, ground frame"},
    {"housing", "mounted", "angular_velocity", KEY_TRIPLE, "rad/s", ANY, DEFAULT("[0, 0, 0]"), "", "",
     "angular velocity at the start, housing frame"},

    {"translation", "", "kind", KEY_CHOICE, "", ANY, REQUIRED, "constant rate harmonic table", "",
     "value; value t; amplitude sin(2 pi frequency t + phase); a spline through knots"},
    {"translation", "", "axis", KEY_CHOICE, "", ANY, REQUIRED, "x y z", "", "component that the term is added to"},
    {"translation", "constant", "value", KEY_NUMBER, "m", ANY, REQUIRED, "", "", "displacement"},
    {"translation", "rate", "value", KEY_NUMBER, "m/s", ANY, REQUIRED, "", "", "velocity"},
    {"translation", "harmonic", "amplitude", KEY_NUMBER, "m", ANY, REQUIRED, "", "", "amplitude"},
    {"translation", "harmonic", "frequency", KEY_NUMBER, "Hz", NOT_NEGATIVE, REQUIRED, "", "", "frequency"},
    {"translation", "harmonic", "phase", KEY_NUMBER, "deg", ANY, DEFAULT("0"), "", "", "phase at time 0"},
    {"translation", "table", "time", KEY_SERIES, "s", ANY, REQUIRED, "", "",
     "knots of the table, strictly increasing, at least two"},
    {"translation", "table", "value", KEY_SERIES, "m", ANY, REQUIRED, "", "",
     "displacement at the knots; natural cubic spline, straight outside"},

    {"rotation", "", "kind", KEY_CHOICE, "", ANY, REQUIRED, "constant rate harmonic table", "",
     "value; value t; amplitude sin(2 pi frequency t + phase); a spline through knots"},
    {"rotation", "", "axis", KEY_CHOICE, "", ANY, REQUIRED, "x y z", "", "component that the term is added to"},
    {"rotation", "constant", "value", KEY_NUMBER, "deg", ANY, REQUIRED, "", "", "angle"},
    {"rotation", "rate", "value", KEY_NUMBER, "rad/s", ANY, REQUIRED, "", "", "rate of the angle"},
    {"rotation", "harmonic", "amplitude", KEY_NUMBER, "deg", ANY, REQUIRED, "", "", "amplitude"},
    {"rotation", "harmonic", "frequency", KEY_NUMBER, "Hz", NOT_NEGATIVE, REQUIRED, "", "", "frequency"},
    {"rotation", "harmonic", "phase", KEY_NUMBER, "deg", ANY, DEFAULT("0"), "", "", "phase at time 0"},
    {"rotation", "table", "time", KEY_SERIES, "s", ANY, REQUIRED, "", "",
     "knots of the table, strictly increasing, at least two"},
    {"rotation", "table", "value", KEY_SERIES, "deg", ANY, REQUIRED, "", "",
     "angle at the knots; natural cubic spline, straight outside"},

    {"mount", "", "point", KEY_TRIPLE, "m", ANY, DEFAULT("[0, 0, 0]"), "", "",
     "where it holds the housing, housing frame; without force where housing and ground frame coincide"},
    {"mount", "", "stiffness", KEY_TRIPLE, "N/m", NOT_NEGATIVE, DEFAULT("[0, 0, 0]"), "", "", "along the ground's axes"},
    {"mount", "", "damping", KEY_TRIPLE, "N s/m", NOT_NEGATIVE, DEFAULT("[0, 0, 0]"), "", "", "along the ground's axes"},
    {"mount", "", "rotational_stiffness", KEY_TRIPLE, "N m/rad", NOT_NEGATIVE, DEFAULT("[0, 0, 0]"), "", "",
     "about x, y, z"},
    {"mount", "", "rotational_damping", KEY_TRIPLE, "N m s/rad", NOT_NEGATIVE, DEFAULT("[0, 0, 0]"), "", "",
     "about the housing's x, y, z"},

    {"simulation", "", "duration", KEY_NUMBER, "s", POSITIVE, REQUIRED, "", "", "model time to compute, from 0"},
    {"simulation", "", "output_interval", KEY_NUMBER, "s", POSITIVE, REQUIRED, "", "",
     "step of the output grid, not longer than the duration"},
    {"simulation", "", "tolerance", KEY_NUMBER, "", BETWEEN(1e-14, 1e-3), DEFAULT("1e-9"), "", "",
     "error allowed in a step, in units of each state's scale"},
    {"simulation", "", "max_step", KEY_NUMBER, "s", POSITIVE, DEFAULT("0.02"), "", "",
     "longest step of the integrator"},
    {"simulation", "", "initial", KEY_BLOCK, "", ANY, DEFAULT("{kind: rest}"), "", "initial", "state at time 0"},
    {"simulation", "", "integrator", KEY_CHOICE, "", ANY, OPTIONAL, "ida radau", "",
     "SUNDIALS IDA for every case; radau for closed_form tracking without rigid contact in a housing that is not mounted, where"
     " it is taken unless this says ida"},

    {"initial", "", "kind", KEY_CHOICE, "", ANY, DEFAULT("rest"), "rest steady speeds", "",
     "at rest; in steady motion under the loads; with given speeds"},
    {"initial", "speeds", "speeds", KEY_NAMED, "rad/s", ANY, REQUIRED, "", "",
     "angular velocity of every wheel by name"},
    {"initial", "rest speeds", "gaps", KEY_NAMED, "m", ANY, DEFAULT("{}"), "", "",
     "gap between the flanks of a mesh by name, 0 if not given; negative: penetration"},
};
/* clang-format on */

static const char *const family_blocks[LAWS_FAMILIES] = {
    [LAWS_CONTACT] = "contact", [LAWS_DAMPING] = "damping", [LAWS_FRICTION] = "friction"};
static const char *const family_texts[LAWS_FAMILIES] = {[LAWS_CONTACT] = "law of the normal elastic force",
                                                        [LAWS_DAMPING] = "law of the normal viscous force",
                                                        [LAWS_FRICTION] = "law of the tangential force"};

/** Keep a text as long as the schema. */
static const char *own(case_schema *schema, char *text)
{
    schema->owned = xrealloc(schema->owned, (size_t)schema->n_owned + 1, sizeof *schema->owned);
    schema->owned[schema->n_owned++] = text;
    return text;
}

static void add_key(case_schema *schema, case_key key)
{
    schema->keys = xrealloc(schema->keys, (size_t)schema->n + 1, sizeof *schema->keys);
    schema->keys[schema->n++] = key;
}

/** The default of a block's `law`: the one in the mesh's default {law: NAME} for the block. */
static const char *default_law(case_schema *schema, const char *block)
{
    const char *text = schema_find(schema, "mesh", "", block)->default_text;
    const char *name = strchr(text, ' ') + 1;
    return own(schema, xasprintf("%.*s", (int)strcspn(name, "}"), name));
}

static void add_law_parameter(case_schema *schema, const char *block, const char *law, const law_parameter *parameter)
{
    case_key key = {.block = block,
                    .variants = law,
                    .key = own(schema, xstrdup(parameter->name)),
                    .type = KEY_NUMBER,
                    .unit = strcmp(parameter->units, "1") == 0 ? "" : own(schema, xstrdup(parameter->units)),
                    .minimum = parameter->minimum,
                    .maximum = parameter->maximum,
                    .minimum_open = parameter->minimum_open,
                    .maximum_open = parameter->maximum_open,
                    .required = parameter->required,
                    .words = "",
                    .holds = "",
                    .text = own(schema, xstrdup(parameter->text))};
    if (!parameter->required) {
        char number[NUMBER_TEXT_LENGTH];
        number_write(number, parameter->default_value);
        key.default_text = own(schema, xstrdup(number));
    }
    /* the same parameter of several laws is one key only if it means the same in all of them: they stay apart */
    add_key(schema, key);
}

static void add_laws(case_schema *schema, law_family family, const law_tables *laws)
{
    const char *block = family_blocks[family];
    char *words = xstrdup("");
    for (int i = 0; i < laws->count[family]; i++) {
        char *longer = xasprintf("%s%s%s", words, i == 0 ? "" : " ", laws->laws[family][i].name);
        free(words);
        words = longer;
    }
    add_key(schema, (case_key){.block = block,
                               .variants = "",
                               .key = "law",
                               .type = KEY_CHOICE,
                               .unit = "",
                               .minimum = -HUGE_VAL,
                               .maximum = HUGE_VAL,
                               .default_text = default_law(schema, block),
                               .words = own(schema, words),
                               .holds = "",
                               .text = family_texts[family]});
    for (int i = 0; i < laws->count[family]; i++) {
        const law_info *law = &laws->laws[family][i];
        const char *name = own(schema, xstrdup(law->name));
        for (int k = 0; k < law->n_parameters; k++) {
            add_law_parameter(schema, block, name, &law->parameters[k]);
        }
    }
}

case_schema *schema_create(const law_tables *laws)
{
    case_schema *schema = xcalloc(1, sizeof *schema);
    for (size_t i = 0; i < sizeof fixed_keys / sizeof *fixed_keys; i++) {
        add_key(schema, fixed_keys[i]);
    }
    for (int family = 0; family < LAWS_FAMILIES; family++) {
        add_laws(schema, (law_family)family, laws);
    }
    return schema;
}

void schema_delete(case_schema **schema)
{
    if (*schema == NULL) {
        return;
    }
    for (int i = 0; i < (*schema)->n_owned; i++) {
        free((*schema)->owned[i]);
    }
    free((*schema)->owned);
    free((*schema)->keys);
    free(*schema);
    *schema = NULL;
}

bool words_contain(const char *words, const char *word)
{
    const size_t length = strlen(word);
    for (const char *start = words; *start != '\0' && length > 0;) {
        const size_t n = strcspn(start, " ");
        if (n == length && strncmp(start, word, n) == 0) {
            return true;
        }
        start += n + strspn(start + n, " ");
    }
    return false;
}

int words_split(const char *words, char ***list)
{
    char *copy = xstrdup(words);
    char **items = xcalloc(strlen(words) / 2 + 2, sizeof *items);
    int n = 0;
    items[0] = copy;
    for (char *start = copy; *start != '\0';) {
        items[n++] = start;
        start += strcspn(start, " ");
        if (*start == ' ') {
            *start++ = '\0';
        }
    }
    *list = items;
    return n;
}

char *words_list(int n, const char *const *words)
{
    char *list = xstrdup("");
    for (int i = 0; i < n; i++) {
        char *longer = xasprintf("%s%s%s", list, i == 0 ? "" : ", ", words[i]);
        free(list);
        list = longer;
    }
    return list;
}

const char *key_needs(const case_key *key)
{
    return key->variants[0] == '+' ? key->variants + 1 : NULL;
}

bool key_in_variant(const case_key *key, const char *variant)
{
    return key->variants[0] == '\0' || key_needs(key) != NULL || words_contain(key->variants, variant);
}

const case_key *schema_find(const case_schema *schema, const char *block, const char *variant, const char *key)
{
    for (int i = 0; i < schema->n; i++) {
        const case_key *row = &schema->keys[i];
        if (strcmp(row->block, block) == 0 && strcmp(row->key, key) == 0 && key_in_variant(row, variant)) {
            return row;
        }
    }
    return NULL;
}

void key_range_text(const case_key *key, char text[128])
{
    const bool is_bounded_below = isfinite(key->minimum), is_bounded_above = isfinite(key->maximum);
    const char *low = key->minimum_open ? "greater than" : "at least";
    const char *high = key->maximum_open ? "less than" : "at most";
    text[0] = '\0';
    if (is_bounded_below && is_bounded_above && !key->minimum_open && !key->maximum_open) {
        (void)snprintf(text, 128, "from %g to %g", key->minimum, key->maximum);
    } else if (is_bounded_below && is_bounded_above) {
        (void)snprintf(text, 128, "%s %g and %s %g", low, key->minimum, high, key->maximum);
    } else if (is_bounded_below) {
        (void)snprintf(text, 128, "%s %g", low, key->minimum);
    } else if (is_bounded_above) {
        (void)snprintf(text, 128, "%s %g", high, key->maximum);
    }
}
