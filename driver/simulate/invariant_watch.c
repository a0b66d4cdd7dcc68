#include "simulate/invariant_watch.h"

#include "base/memory.h"
#include "simulate/each_processor.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { GRADIENT_RATIO, TRANSMISSION_ERROR, POINTS_ON_FLANKS, POINTS_ON_LINE, RIGID_GAP, ENERGY_BALANCE, N_INVARIANTS };

/** As in postprocess/evolvent/physics/invariants.py; tests/system/test_run_invariants.py compares. */
static const struct {
    const char *name;
    double least_bound, tolerances; /**< the bound is at least this multiple of the tolerance */
} invariants[N_INVARIANTS] = {
    [GRADIENT_RATIO] = {"gradient ratio", 1e-12, 1e-3},
    [TRANSMISSION_ERROR] = {"transmission error", 1e-10, 1},
    [POINTS_ON_FLANKS] = {"points on flanks", 1e-10, 1},
    [POINTS_ON_LINE] = {"points on line of action", 1e-10, 1},
    [RIGID_GAP] = {"rigid gap", 2e-10, 1},
    [ENERGY_BALANCE] = {"energy balance", 1e-10, 10},
};
static const double least_depth_bound = 1e-10, rounding = 4 * DBL_EPSILON;

/** Outputs to check. */
#define OUTPUTS(X)                                                                                                     \
    X(KINETIC, "kinetic_energy")                                                                                       \
    X(POTENTIAL, "potential_energy")                                                                                   \
    X(DISSIPATED, "dissipated_energy")                                                                                 \
    X(WORK, "load_work")                                                                                               \
    X(TORQUE, "load_torque")                                                                                           \
    X(ANGULAR_VELOCITY, "angular_velocity")                                                                            \
    X(ANGLE_DEVIATION, "angle_deviation")                                                                              \
    X(CENTRE_DISPLACEMENT, "centre_displacement")                                                                      \
    X(BASE_RADIUS, "base_radius")                                                                                      \
    X(DRIVING_WHEEL, "driving_wheel")                                                                                  \
    X(DRIVEN_WHEEL, "driven_wheel")                                                                                    \
    X(TRACKING, "tracking")                                                                                            \
    X(CONTACT_MODE, "contact_mode")                                                                                    \
    X(RIGID, "rigid_contact")                                                                                          \
    X(LAG, "transmission_error")                                                                                       \
    X(GAP, "gap")                                                                                                      \
    X(DEVIATION, "flank_deviation")                                                                                    \
    X(CURVATURE, "separation_curvature")                                                                               \
    X(PENETRATION, "penetration")                                                                                      \
    X(REFERENCE_PENETRATION, "reference_penetration")                                                                  \
    X(REFERENCE_FORCE, "reference_force")                                                                              \
    X(RATIO, "gradient_ratio")                                                                                         \
    X(RESIDUAL_DRIVING, "tracking_residual_driving")                                                                   \
    X(RESIDUAL_DRIVEN, "tracking_residual_driven")                                                                     \
    X(LINE_DRIVING, "line_distance_driving")                                                                           \
    X(LINE_DRIVEN, "line_distance_driven")

#define OUTPUT_PLACE(place, name) place,
enum { OUTPUTS(OUTPUT_PLACE) N_OUTPUTS };
#undef OUTPUT_PLACE
#define OUTPUT_NAME(place, name) name,
static const char *const names[N_OUTPUTS] = {OUTPUTS(OUTPUT_NAME)};
#undef OUTPUT_NAME
static const double mode_loaded = 1, mode_apart = 3; /**< apart: flanks too far apart to track points on them */

struct invariant_watch {
    int n_wheels, n_meshes;
    double tolerance;
    bool is_tracked;       /**< points are tracked in at least one mesh */
    int places[N_OUTPUTS]; /**< index of the first value; of static outputs among the constants; -1: no such output */
    double *constants;     /**< [n_values] of the model */
    bool has_begun;
    double t, power;                    /**< of the previous outputs */
    double start, stored;               /**< balance and stored energy at the start */
    double drift, gross, largest, unit; /**< of the energy [J] */
    double ratio;                       /**< largest error */
    struct of_wheel {
        double arc, moved[2]; /**< largest values [m] */
        double base_radius;
    } *wheels;
    struct of_mesh {
        int driving, driven;
        double depth, on_flanks, on_line, identity, closed_gap; /**< largest values [m] */
        bool was_pressed;
    } *meshes;
};

/** Value of a static output. */
static double constant(const invariant_watch *watch, int output, int element)
{
    return watch->constants[watch->places[output] + element];
}

invariant_watch *invariant_watch_create(wanted_outputs *wanted, int n_wheels, int n_meshes, double tolerance)
{
    invariant_watch *watch = xcalloc(1, sizeof *watch);
    *watch = (invariant_watch){.n_wheels = n_wheels, .n_meshes = n_meshes, .tolerance = tolerance};
    watch->wheels = xcalloc((size_t)n_wheels, sizeof *watch->wheels);
    watch->meshes = xcalloc((size_t)n_meshes, sizeof *watch->meshes);
    watch->constants = xcalloc((size_t)model_about(wanted->model)->n_values, sizeof *watch->constants);
    model_constants(wanted->model, watch->constants);
    for (int i = 0; i < N_OUTPUTS; i++) {
        const model_output *output = model_output_named(wanted->model, names[i]);
        if (output != NULL && output->is_static) {
            watch->places[i] = output->offset;
        } else if (i < RATIO || watch->is_tracked) {
            watch->places[i] = wanted_add(wanted, names[i]);
        }
        for (int mesh = 0; i == TRACKING && mesh < n_meshes && watch->places[i] >= 0; mesh++) {
            watch->is_tracked = watch->is_tracked || constant(watch, TRACKING, mesh) > 0;
        }
    }
    return watch;
}

void invariant_watch_keep(invariant_watch *watch, archive *archive)
{
    KEEP(archive, watch->has_begun);
    KEEP(archive, watch->t);
    KEEP(archive, watch->power);
    KEEP(archive, watch->start);
    KEEP(archive, watch->stored);
    KEEP(archive, watch->drift);
    KEEP(archive, watch->gross);
    KEEP(archive, watch->largest);
    KEEP(archive, watch->unit);
    KEEP(archive, watch->ratio);
    KEEP_ARRAY(archive, watch->wheels, watch->n_wheels);
    KEEP_ARRAY(archive, watch->meshes, watch->n_meshes);
}

void invariant_watch_delete(invariant_watch **watch)
{
    if (*watch != NULL) {
        free((*watch)->constants);
        free((*watch)->wheels);
        free((*watch)->meshes);
        free(*watch);
        *watch = NULL;
    }
}

static inline double larger(double largest, double value)
{
    return isnan(largest) || fabs(value) <= largest ? largest : fabs(value); /* a NaN is retained */
}

/** The larger of two, the first of which is not NaN: fmax is a function call. */
static inline double largest_of(double largest, double value)
{
    return value > largest ? value : largest;
}

/** Largest of DAE_LANES numbers and the previous largest value. */
static inline double largest_of_lanes(double largest, const double values[DAE_LANES])
{
    double two[2] = {largest, largest}; /* compared in parallel by the processor */
    for (int k = 0; k < DAE_LANES; k += 2) {
        two[0] = values[k] > two[0] ? values[k] : two[0];
        two[1] = values[k + 1] > two[1] ? values[k + 1] : two[1];
    }
    return largest_of(two[0], two[1]);
}

/** Largest |factor*value| at all times of a block. */
static inline double largest_in(const output_block *block, int place, double factor, double largest)
{
    const double *values = output_values(block, place);
    double sizes[DAE_LANES];
    for (int k = 0; k < DAE_LANES; k++) {
        sizes[k] = fabs(factor * values[k]);
    }
    return largest_of_lanes(largest, sizes);
}

/** As `larger`, applied to the first n of the numbers in turn. */
static inline double larger_of(double largest, int n, const double values[DAE_LANES])
{
    double sizes[DAE_LANES];
    bool are_numbers = true;
    for (int k = 0; k < DAE_LANES; k++) {
        sizes[k] = k < n ? fabs(values[k]) : 0;
        are_numbers = are_numbers && !isnan(sizes[k]);
    }
    return are_numbers ? larger(largest, largest_of_lanes(0, sizes)) : NAN;
}

static inline void look_at_energy(invariant_watch *watch, const output_block *block)
{
    const double *of[WORK + 1];
    double power[DAE_LANES] = {0}, balance[DAE_LANES];
    for (int i = KINETIC; i <= WORK; i++) {
        of[i] = output_values(block, watch->places[i]);
        watch->largest = largest_in(block, watch->places[i], 1, watch->largest);
    }
    for (int i = 0; i < watch->n_wheels; i++) {
        const double *torque = output_values(block, watch->places[TORQUE] + i);
        const double *speed = output_values(block, watch->places[ANGULAR_VELOCITY] + i);
        for (int k = 0; k < DAE_LANES; k++) {
            const double given = torque[k] * speed[k];
            power[k] += given > 0 ? given : 0;
        }
    }
    if (!watch->has_begun) {
        const double stored = of[KINETIC][0] + of[POTENTIAL][0];
        watch->has_begun = true;
        watch->start = stored + of[DISSIPATED][0] - of[WORK][0];
        watch->stored = fabs(stored);
        watch->t = block->t[0];
        watch->power = power[0];
    }
    for (int k = 0; k < DAE_LANES; k++) {
        balance[k] = of[KINETIC][k] + of[POTENTIAL][k] + of[DISSIPATED][k] - of[WORK][k] - watch->start;
    }
    watch->drift = larger_of(watch->drift, block->n, balance);
    double gross = watch->gross, t = watch->t, before = watch->power;
    for (int k = 0; k < block->n; k++) {
        gross += (block->t[k] - t) * (power[k] + before) / 2;
        t = block->t[k];
        before = power[k];
    }
    watch->gross = gross;
    watch->t = t;
    watch->power = before;
}

static inline void look_at_wheel(invariant_watch *watch, int i, const output_block *block)
{
    struct of_wheel *wheel = &watch->wheels[i];
    const int *places = watch->places;
    wheel->base_radius = constant(watch, BASE_RADIUS, i);
    wheel->arc = largest_in(block, places[ANGLE_DEVIATION] + i, wheel->base_radius, wheel->arc);
    for (int axis = 0; axis < 2; axis++) {
        wheel->moved[axis] = largest_in(block, places[CENTRE_DISPLACEMENT] + 2 * i + axis, 1, wheel->moved[axis]);
    }
}

/** Check a mesh with tracked points, at one time. */
static void look_at_points(invariant_watch *watch, int i, const double *const of[N_OUTPUTS], int k)
{
    struct of_mesh *mesh = &watch->meshes[i];
    const double radii = watch->wheels[mesh->driving].base_radius / watch->wheels[mesh->driven].base_radius;
    watch->ratio = larger(watch->ratio, of[RATIO][k] * radii + 1);
    mesh->on_flanks = larger(larger(mesh->on_flanks, of[RESIDUAL_DRIVING][k]), of[RESIDUAL_DRIVEN][k]);
    mesh->on_line = larger(larger(mesh->on_line, of[LINE_DRIVING][k]), of[LINE_DRIVEN][k]);
}

static bool is_constant(int output)
{
    return output == RIGID || output == REFERENCE_PENETRATION || output == REFERENCE_FORCE;
}

static inline void look_at_mesh(invariant_watch *watch, int i, const output_block *block)
{
    struct of_mesh *mesh = &watch->meshes[i];
    const double *of[N_OUTPUTS];
    for (int output = CONTACT_MODE; output < N_OUTPUTS; output++) {
        of[output] = is_constant(output) || (output >= RATIO && !watch->is_tracked)
                         ? NULL
                         : output_values(block, watch->places[output] + i);
    }
    const bool is_rigid = constant(watch, RIGID, i) == 1, is_tracked = constant(watch, TRACKING, i) > 0;
    mesh->driving = (int)constant(watch, DRIVING_WHEEL, i);
    mesh->driven = (int)constant(watch, DRIVEN_WHEEL, i);
    mesh->depth = largest_of(mesh->depth, constant(watch, REFERENCE_PENETRATION, i));
    mesh->depth = largest_in(block, watch->places[PENETRATION] + i, 1, mesh->depth);
    double identity[DAE_LANES];
    for (int k = 0; k < DAE_LANES; k++) {
        identity[k] = of[LAG][k] + of[GAP][k] - of[DEVIATION][k] - of[CURVATURE][k];
    }
    mesh->identity = larger_of(mesh->identity, block->n, identity);
    for (int k = 0; k < block->n && !mesh->was_pressed; k++) {
        mesh->was_pressed = of[PENETRATION][k] > 0 || of[CONTACT_MODE][k] == mode_loaded;
    }
    for (int k = 0; k < block->n && (is_rigid || is_tracked); k++) {
        if (is_rigid && of[CONTACT_MODE][k] == mode_loaded) {
            mesh->closed_gap = larger(mesh->closed_gap, of[GAP][k]);
        }
        if (is_tracked && of[CONTACT_MODE][k] != mode_apart) {
            look_at_points(watch, i, of, k);
        }
    }
    watch->unit += constant(watch, REFERENCE_FORCE, i) * constant(watch, REFERENCE_PENETRATION, i);
}

FOR_EACH_PROCESSOR void invariant_watch_outputs(invariant_watch *watch, const output_block *block)
{
    for (int i = 0; i < N_OUTPUTS; i++) {
        if (watch->places[i] < 0) {
            return; /* a model without gears, as in tests */
        }
    }
    look_at_energy(watch, block);
    for (int i = 0; i < watch->n_wheels; i++) {
        look_at_wheel(watch, i, block);
    }
    watch->unit = 0;
    for (int i = 0; i < watch->n_meshes; i++) {
        look_at_mesh(watch, i, block);
    }
}

/** Reference length of a mesh: the penetration, but at least the rounding error of the lengths involved. */
static double depth_of(const invariant_watch *watch, const struct of_mesh *mesh)
{
    const struct of_wheel *a = &watch->wheels[mesh->driving], *b = &watch->wheels[mesh->driven];
    const double lengths = a->arc + a->moved[0] + a->moved[1] + b->arc + b->moved[0] + b->moved[1];
    return fmax(mesh->depth, rounding * lengths / least_depth_bound);
}

static void find_deviations(const invariant_watch *watch, double worst[N_INVARIANTS])
{
    const double scale = fmax(fmax(watch->gross + watch->stored, watch->largest), watch->unit);
    worst[GRADIENT_RATIO] = watch->ratio;
    worst[TRANSMISSION_ERROR] = worst[POINTS_ON_FLANKS] = worst[POINTS_ON_LINE] = worst[RIGID_GAP] = 0;
    worst[ENERGY_BALANCE] = watch->has_begun ? watch->drift / scale : 0;
    for (int i = 0; i < watch->n_meshes; i++) {
        const struct of_mesh *mesh = &watch->meshes[i];
        if (mesh->was_pressed) {
            const double depth = depth_of(watch, mesh);
            worst[TRANSMISSION_ERROR] = larger(worst[TRANSMISSION_ERROR], mesh->identity / depth);
            worst[RIGID_GAP] = larger(worst[RIGID_GAP], mesh->closed_gap / depth);
            worst[POINTS_ON_FLANKS] = larger(worst[POINTS_ON_FLANKS], mesh->on_flanks / depth);
            worst[POINTS_ON_LINE] = larger(worst[POINTS_ON_LINE], mesh->on_line / depth);
        }
    }
}

double invariant_watch_energy(const invariant_watch *watch)
{
    const double scale = fmax(watch->gross + watch->stored, watch->largest);
    return scale > 0 ? watch->drift / scale : NAN;
}

bool invariant_watch_tell(const invariant_watch *watch, char *text, size_t size)
{
    double worst[N_INVARIANTS];
    bool held = true;
    find_deviations(watch, worst);
    (void)snprintf(text, size, "held");
    for (int i = 0; i < N_INVARIANTS; i++) {
        const double bound = fmax(invariants[i].least_bound, invariants[i].tolerances * watch->tolerance);
        if (!(worst[i] <= bound)) {
            const size_t length = held ? 0 : strlen(text);
            (void)snprintf(text + length, size - length, "%s%s %.3g, bound %.3g", held ? "broken: " : "; ",
                           invariants[i].name, worst[i], bound);
            held = false;
        }
    }
    return held;
}
