#include "simulate/invariant_monitor.h"

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

#define OUTPUT_KEY(index, name) index,
enum { OUTPUTS(OUTPUT_KEY) N_OUTPUTS };
#undef OUTPUT_KEY
#define OUTPUT_NAME(index, name) name,
static const char *const names[N_OUTPUTS] = {OUTPUTS(OUTPUT_NAME)};
#undef OUTPUT_NAME
static const double mode_loaded = 1, mode_apart = 3; /**< apart: flanks too far apart to track points on them */

struct invariant_monitor {
    int n_wheels, n_meshes;
    double tolerance;
    bool is_tracked;        /**< points are tracked in at least one mesh */
    int offsets[N_OUTPUTS]; /**< index of the first value; of static outputs among the constants; -1: no such output */
    double *constants;      /**< [n_values] of the model */
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
static double constant(const invariant_monitor *monitor, int output, int element)
{
    return monitor->constants[monitor->offsets[output] + element];
}

invariant_monitor *invariant_monitor_create(requested_outputs *requested, int n_wheels, int n_meshes, double tolerance)
{
    invariant_monitor *monitor = xcalloc(1, sizeof *monitor);
    *monitor = (invariant_monitor){.n_wheels = n_wheels, .n_meshes = n_meshes, .tolerance = tolerance};
    monitor->wheels = xcalloc((size_t)n_wheels, sizeof *monitor->wheels);
    monitor->meshes = xcalloc((size_t)n_meshes, sizeof *monitor->meshes);
    monitor->constants = xcalloc((size_t)model_about(requested->model)->n_values, sizeof *monitor->constants);
    model_constants(requested->model, monitor->constants);
    for (int i = 0; i < N_OUTPUTS; i++) {
        const model_output *output = model_output_named(requested->model, names[i]);
        if (output != NULL && output->is_static) {
            monitor->offsets[i] = output->offset;
        } else if (i < RATIO || monitor->is_tracked) {
            monitor->offsets[i] = requested_outputs_add(requested, names[i]);
        }
        for (int mesh = 0; i == TRACKING && mesh < n_meshes && monitor->offsets[i] >= 0; mesh++) {
            monitor->is_tracked = monitor->is_tracked || constant(monitor, TRACKING, mesh) > 0;
        }
    }
    return monitor;
}

void invariant_monitor_serialize(invariant_monitor *monitor, archive *archive)
{
    SERIALIZE(archive, monitor->has_begun);
    SERIALIZE(archive, monitor->t);
    SERIALIZE(archive, monitor->power);
    SERIALIZE(archive, monitor->start);
    SERIALIZE(archive, monitor->stored);
    SERIALIZE(archive, monitor->drift);
    SERIALIZE(archive, monitor->gross);
    SERIALIZE(archive, monitor->largest);
    SERIALIZE(archive, monitor->unit);
    SERIALIZE(archive, monitor->ratio);
    SERIALIZE_ARRAY(archive, monitor->wheels, monitor->n_wheels);
    SERIALIZE_ARRAY(archive, monitor->meshes, monitor->n_meshes);
}

void invariant_monitor_delete(invariant_monitor **monitor)
{
    if (*monitor != NULL) {
        free((*monitor)->constants);
        free((*monitor)->wheels);
        free((*monitor)->meshes);
        free(*monitor);
        *monitor = NULL;
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
static inline double largest_in(const output_block *block, int index, double factor, double largest)
{
    const double *values = output_values(block, index);
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

static inline void look_at_energy(invariant_monitor *monitor, const output_block *block)
{
    const double *of[WORK + 1];
    double power[DAE_LANES] = {0}, balance[DAE_LANES];
    for (int i = KINETIC; i <= WORK; i++) {
        of[i] = output_values(block, monitor->offsets[i]);
        monitor->largest = largest_in(block, monitor->offsets[i], 1, monitor->largest);
    }
    for (int i = 0; i < monitor->n_wheels; i++) {
        const double *torque = output_values(block, monitor->offsets[TORQUE] + i);
        const double *speed = output_values(block, monitor->offsets[ANGULAR_VELOCITY] + i);
        for (int k = 0; k < DAE_LANES; k++) {
            const double input = torque[k] * speed[k];
            power[k] += input > 0 ? input : 0;
        }
    }
    if (!monitor->has_begun) {
        const double stored = of[KINETIC][0] + of[POTENTIAL][0];
        monitor->has_begun = true;
        monitor->start = stored + of[DISSIPATED][0] - of[WORK][0];
        monitor->stored = fabs(stored);
        monitor->t = block->t[0];
        monitor->power = power[0];
    }
    for (int k = 0; k < DAE_LANES; k++) {
        balance[k] = of[KINETIC][k] + of[POTENTIAL][k] + of[DISSIPATED][k] - of[WORK][k] - monitor->start;
    }
    monitor->drift = larger_of(monitor->drift, block->n, balance);
    double gross = monitor->gross, t = monitor->t, before = monitor->power;
    for (int k = 0; k < block->n; k++) {
        gross += (block->t[k] - t) * (power[k] + before) / 2;
        t = block->t[k];
        before = power[k];
    }
    monitor->gross = gross;
    monitor->t = t;
    monitor->power = before;
}

static inline void look_at_wheel(invariant_monitor *monitor, int i, const output_block *block)
{
    struct of_wheel *wheel = &monitor->wheels[i];
    const int *offsets = monitor->offsets;
    wheel->base_radius = constant(monitor, BASE_RADIUS, i);
    wheel->arc = largest_in(block, offsets[ANGLE_DEVIATION] + i, wheel->base_radius, wheel->arc);
    for (int axis = 0; axis < 2; axis++) {
        wheel->moved[axis] = largest_in(block, offsets[CENTRE_DISPLACEMENT] + 2 * i + axis, 1, wheel->moved[axis]);
    }
}

/** Check a mesh with tracked points, at one time. */
static void look_at_points(invariant_monitor *monitor, int i, const double *const of[N_OUTPUTS], int k)
{
    struct of_mesh *mesh = &monitor->meshes[i];
    const double radii = monitor->wheels[mesh->driving].base_radius / monitor->wheels[mesh->driven].base_radius;
    monitor->ratio = larger(monitor->ratio, of[RATIO][k] * radii + 1);
    mesh->on_flanks = larger(larger(mesh->on_flanks, of[RESIDUAL_DRIVING][k]), of[RESIDUAL_DRIVEN][k]);
    mesh->on_line = larger(larger(mesh->on_line, of[LINE_DRIVING][k]), of[LINE_DRIVEN][k]);
}

static bool is_constant(int output)
{
    return output == RIGID || output == REFERENCE_PENETRATION || output == REFERENCE_FORCE;
}

static inline void look_at_mesh(invariant_monitor *monitor, int i, const output_block *block)
{
    struct of_mesh *mesh = &monitor->meshes[i];
    const double *of[N_OUTPUTS];
    for (int output = CONTACT_MODE; output < N_OUTPUTS; output++) {
        of[output] = is_constant(output) || (output >= RATIO && !monitor->is_tracked)
                         ? NULL
                         : output_values(block, monitor->offsets[output] + i);
    }
    const bool is_rigid = constant(monitor, RIGID, i) == 1, is_tracked = constant(monitor, TRACKING, i) > 0;
    mesh->driving = (int)constant(monitor, DRIVING_WHEEL, i);
    mesh->driven = (int)constant(monitor, DRIVEN_WHEEL, i);
    mesh->depth = largest_of(mesh->depth, constant(monitor, REFERENCE_PENETRATION, i));
    mesh->depth = largest_in(block, monitor->offsets[PENETRATION] + i, 1, mesh->depth);
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
            look_at_points(monitor, i, of, k);
        }
    }
    monitor->unit += constant(monitor, REFERENCE_FORCE, i) * constant(monitor, REFERENCE_PENETRATION, i);
}

FOR_EACH_PROCESSOR void invariant_monitor_outputs(invariant_monitor *monitor, const output_block *block)
{
    for (int i = 0; i < N_OUTPUTS; i++) {
        if (monitor->offsets[i] < 0) {
            return; /* a model without gears, as in tests */
        }
    }
    look_at_energy(monitor, block);
    for (int i = 0; i < monitor->n_wheels; i++) {
        look_at_wheel(monitor, i, block);
    }
    monitor->unit = 0;
    for (int i = 0; i < monitor->n_meshes; i++) {
        look_at_mesh(monitor, i, block);
    }
}

/** Reference length of a mesh: the penetration, but at least the rounding error of the lengths involved. */
static double depth_of(const invariant_monitor *monitor, const struct of_mesh *mesh)
{
    const struct of_wheel *a = &monitor->wheels[mesh->driving], *b = &monitor->wheels[mesh->driven];
    const double lengths = a->arc + a->moved[0] + a->moved[1] + b->arc + b->moved[0] + b->moved[1];
    return fmax(mesh->depth, rounding * lengths / least_depth_bound);
}

static void find_deviations(const invariant_monitor *monitor, double worst[N_INVARIANTS])
{
    const double scale = fmax(fmax(monitor->gross + monitor->stored, monitor->largest), monitor->unit);
    worst[GRADIENT_RATIO] = monitor->ratio;
    worst[TRANSMISSION_ERROR] = worst[POINTS_ON_FLANKS] = worst[POINTS_ON_LINE] = worst[RIGID_GAP] = 0;
    worst[ENERGY_BALANCE] = monitor->has_begun ? monitor->drift / scale : 0;
    for (int i = 0; i < monitor->n_meshes; i++) {
        const struct of_mesh *mesh = &monitor->meshes[i];
        if (mesh->was_pressed) {
            const double depth = depth_of(monitor, mesh);
            worst[TRANSMISSION_ERROR] = larger(worst[TRANSMISSION_ERROR], mesh->identity / depth);
            worst[RIGID_GAP] = larger(worst[RIGID_GAP], mesh->closed_gap / depth);
            worst[POINTS_ON_FLANKS] = larger(worst[POINTS_ON_FLANKS], mesh->on_flanks / depth);
            worst[POINTS_ON_LINE] = larger(worst[POINTS_ON_LINE], mesh->on_line / depth);
        }
    }
}

double invariant_monitor_energy(const invariant_monitor *monitor)
{
    const double scale = fmax(monitor->gross + monitor->stored, monitor->largest);
    return scale > 0 ? monitor->drift / scale : NAN;
}

bool invariant_monitor_report(const invariant_monitor *monitor, char *text, size_t size)
{
    double worst[N_INVARIANTS];
    bool held = true;
    find_deviations(monitor, worst);
    (void)snprintf(text, size, "held");
    for (int i = 0; i < N_INVARIANTS; i++) {
        const double bound = fmax(invariants[i].least_bound, invariants[i].tolerances * monitor->tolerance);
        if (!(worst[i] <= bound)) {
            const size_t length = held ? 0 : strlen(text);
            (void)snprintf(text + length, size - length, "%s%s %.3g, bound %.3g", held ? "broken: " : "; ",
                           invariants[i].name, worst[i], bound);
            held = false;
        }
    }
    return held;
}
