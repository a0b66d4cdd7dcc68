#include "commands/static_print.h"

#include "base/json.h"
#include "base/memory.h"

#include <math.h>
#include <string.h>

/** Whether a wheel of the mesh is compliant. */
static bool is_compliant(const static_analysis *analysis)
{
    evl_output compliance[EVL_MOST_QUANTITIES];
    return model_geometry(analysis->of_case->model, EVL_OF_COMPLIANCE, analysis->plan.mesh, compliance) > 0;
}

/** A result for a torque, in the unit of the output. */
static double number_of(const static_analysis *analysis, int torque, const char *output)
{
    const static_plan *plan = &analysis->plan;
    int i = 0;
    while (i < plan->n_outputs && strcmp(plan->outputs[i].name, output) != 0) {
        i++;
    }
    return i < plan->n_outputs ? analysis->numbers[torque * plan->n_outputs + i] : NAN;
}

/* ---- text ---- */

static const struct {
    const char *output, *head[3], *unit;
    double factor;
} columns[] = {
    {"line_load", {"", "line", "load"}, "N/mm", 1e-3},
    {"mean_transmission_error", {"transmission", "error", "mean"}, "um", 1e6},
    {"peak_to_peak_transmission_error", {"", "peak", "to peak"}, "um", 1e6},
    {"mesh_stiffness_per_width", {"mesh", "stiffness", "mean secant"}, "N/(mm um)", 1e-9},
    {"loaded_contact_ratio", {"contact", "ratio", "under load"}, "", 1.0},
    {"largest_force_share", {"largest", "force", "share"}, "", 1.0},
    {"largest_contact_pressure", {"", "largest", "pressure"}, "MPa", 1e-6},
    {"largest_edge_force", {"largest", "corner", "force"}, "N", 1.0},
};

enum { N_COLUMNS = sizeof columns / sizeof *columns, WIDTH = 12, POINT_WIDTH = 9, DIGITS = 4 };

static void print_head(FILE *stream)
{
    for (int line = 0; line < 3; line++) {
        fprintf(stream, "  %*s", WIDTH - 2, line == 2 ? "torque" : "");
        for (int i = 0; i < N_COLUMNS; i++) {
            fprintf(stream, "  %*s", WIDTH, columns[i].head[line]);
        }
        fputc('\n', stream);
    }
    fprintf(stream, "  %*s", WIDTH - 2, "N m");
    for (int i = 0; i < N_COLUMNS; i++) {
        fprintf(stream, "  %*s", WIDTH, columns[i].unit);
    }
    fputc('\n', stream);
}

static void print_row(FILE *stream, const static_analysis *analysis, int torque)
{
    fprintf(stream, "  %*.*g", WIDTH - 2, DIGITS + 1, analysis->torques[torque]);
    for (int i = 0; i < N_COLUMNS; i++) {
        fprintf(stream, "  %*.*g", WIDTH, DIGITS, number_of(analysis, torque, columns[i].output) * columns[i].factor);
    }
    fputc('\n', stream);
}

/** A stress in MPa; a blank for none. */
static void print_stress(FILE *stream, double stress)
{
    if (isnan(stress)) {
        fprintf(stream, "  %*s", POINT_WIDTH, "-");
    } else {
        fprintf(stream, "  %*.*g", POINT_WIDTH, DIGITS, stress * 1e-6);
    }
}

/** Name the corner contact that a largest pressure leaves out. */
static void print_corner(FILE *stream, double force)
{
    if (force > 0) {
        fprintf(stream, "; corner contact, no rounding given: pressure undefined, force %.3g kN", force * 1e-3);
    }
}

/** Note that the largest pressure leaves out sharp tip edges. */
static void print_edges(FILE *stream, const static_analysis *analysis)
{
    double force = 0;
    for (int i = 0; i < analysis->n_torques; i++) {
        force = fmax(force, number_of(analysis, i, "sharp_edge_force"));
    }
    if (force > 0) {
        fprintf(stream,
                "Largest pressure without corner contact: no rounding given, pressure undefined, force up to %.3g kN.\n"
                "'tip_rounding' of the wheels gives one, docs/theory/compliant_flanks.md.\n",
                force * 1e-3);
    }
}

/** Index of the last torque; there is at least one. */
static int last_torque(const static_analysis *analysis)
{
    return analysis->n_torques > 1 ? analysis->n_torques - 1 : 0;
}

/** Compare the mean stiffness at the last torque with ISO 6336-1, for compliant teeth and gear bodies. */
static void print_softness(FILE *stream, const static_analysis *analysis)
{
    static const double low = 0.8; /* relative to c_gamma */
    const int last = last_torque(analysis);
    const double ratio = number_of(analysis, last, "mesh_stiffness_per_width") /
                         number_of(analysis, last, "iso_mesh_stiffness_per_width");
    if (is_compliant(analysis) && ratio < low) {
        fprintf(stream,
                "The mean stiffness is %.2g of c_gamma: the bodies are compliant down to hub_diameter, by default the "
                "bore;\ngive both wheels the diameter of the stiff shaft or hub, docs/theory/compliance.md.\n",
                ratio);
    }
}

/** Print the loss factor of equal shares beside that of the shares under load. */
static void print_loss_factor(FILE *stream, const static_analysis *analysis)
{
    const int last = last_torque(analysis);
    const double equal = number_of(analysis, 0, "tooth_loss_factor");
    fputs("Tooth loss factor: H_V ", stream);
    if (isnan(equal)) {
        fputs("not defined for this path of contact", stream);
    } else {
        fprintf(stream, "%.4g with equal load shares", equal);
    }
    fprintf(stream, ", H_VL %.4g with the shares under %.5g N m, corner contact included.\n",
            number_of(analysis, last, "loaded_tooth_loss_factor"), analysis->torques[last]);
}

/** Whether a point of the path has a nominal pressure, but none under the simulated force: its flanks are too concave. */
static bool is_concave(const static_analysis *analysis, int point)
{
    CLEANUP_FREE char *found = xasprintf("contact_pressure_at_%c", point);
    CLEANUP_FREE char *nominal = xasprintf("nominal_pressure_at_%c", point);
    bool is = false;
    for (int torque = 0; torque < analysis->n_torques; torque++) {
        is = is || (isnan(number_of(analysis, torque, found)) && !isnan(number_of(analysis, torque, nominal)));
    }
    return is;
}

/** Name the points without a pressure, which the maximum leaves out. */
static void print_concave(FILE *stream, const static_analysis *analysis)
{
    for (int point = 'a'; point <= 'e'; point++) {
        if (is_concave(analysis, point)) {
            fprintf(stream,
                    "Largest pressure without point %c: a relieved flank is too concave there for a Hertz pressure, "
                    "docs/theory/deviations.md.\n",
                    point - 'a' + 'A');
        }
    }
}

/** Print the contact pressure at points of the path, and its maximum. */
static void print_pressures(FILE *stream, const static_analysis *analysis)
{
    static const char *const points[] = {"a", "b", "c", "d", "e"};
    static const char *const rows[][2] = {{"contact_pressure_at_", "quasi-static"},
                                          {"nominal_pressure_at_", "nominal"}};
    fputs("\nContact pressure of a tooth pair at the points of the path of contact, and its maximum over the path "
          "[MPa]\n",
          stream);
    fprintf(stream, "  %-12s  %*s", "", WIDTH - 2, "torque");
    for (int i = 0; i < 5; i++) {
        fprintf(stream, "  %*c", POINT_WIDTH, points[i][0] - 'a' + 'A');
    }
    fprintf(stream, "  %*s\n", POINT_WIDTH, "maximum");
    for (int torque = 0; torque < analysis->n_torques; torque++) {
        for (int row = 0; row < 2; row++) {
            fprintf(stream, "  %-12s  %*.*g", rows[row][1], WIDTH - 2, DIGITS + 1, analysis->torques[torque]);
            for (int i = 0; i < 5; i++) {
                CLEANUP_FREE char *name = xasprintf("%s%s", rows[row][0], points[i]);
                print_stress(stream, number_of(analysis, torque, name));
            }
            if (row == 0) {
                print_stress(stream, number_of(analysis, torque, "largest_contact_pressure"));
                print_corner(stream, number_of(analysis, torque, "sharp_edge_force"));
            }
            fputc('\n', stream);
        }
    }
    print_concave(stream, analysis);
}

/** Print the extremes of the root stress with their teeth and arcs. */
static void print_root_stress(FILE *stream, const static_analysis *analysis)
{
    static const char *const wheels[] = {"driving", "driven"}, *const extremes[] = {"max", "min"};
    static const struct {
        const char *name, *head, *unit;
        double factor;
    } values[] = {{"", "", "MPa", 1e-6},
                  {"_x", "position", "pitches", 1},
                  {"_tooth", "tooth", "", 1},
                  {"_arc", "arc", "mm", 1e3}};
    if (analysis->plan.n_wheels == 0) {
        if (is_compliant(analysis)) {
            fputs("No root stress: neither wheel has a compliance by finite elements.\n", stream);
        }
        return;
    }
    fputs(
        "\nRoot stress, largest and least over the path, tooth (from 0, counterclockwise), arc from the form circle\n",
        stream);
    for (int line = 0; line < 2; line++) {
        fprintf(stream, "  %*s  %*s", WIDTH - 2, line == 0 ? "wheel" : "", WIDTH - 2, line == 0 ? "torque" : "N m");
        for (int i = 0; i < 8; i++) {
            const char *of = line == 1   ? values[i % 4].unit
                             : i % 4 > 0 ? values[i % 4].head
                             : i == 0    ? "largest"
                                         : "least";
            fprintf(stream, "  %*s", POINT_WIDTH, of);
        }
        fputc('\n', stream);
    }
    for (int wheel = 0; wheel < 2; wheel++) {
        CLEANUP_FREE char *largest = xasprintf("root_stress_max_%s", wheels[wheel]);
        if (isnan(number_of(analysis, 0, largest))) {
            fprintf(stream, "No root stress of the %s wheel: it has no compliance by finite elements.\n",
                    wheels[wheel]);
            continue;
        }
        for (int torque = 0; torque < analysis->n_torques; torque++) {
            fprintf(stream, "  %*s  %*.*g", WIDTH - 2, wheels[wheel], WIDTH - 2, DIGITS + 1, analysis->torques[torque]);
            for (int i = 0; i < 8; i++) {
                CLEANUP_FREE char *name =
                    xasprintf("root_stress_%s%s_%s", extremes[i / 4], values[i % 4].name, wheels[wheel]);
                fprintf(stream, "  %*.*g", POINT_WIDTH, DIGITS,
                        number_of(analysis, torque, name) * values[i % 4].factor);
            }
            fputc('\n', stream);
        }
    }
    fputs("Uniform stress over the face width (K_Fbeta = K_Hbeta = 1), no friction along the flank.\n", stream);
}

void static_print_text(FILE *stream, const static_analysis *analysis)
{
    const static_plan *plan = &analysis->plan;
    const int last = last_torque(analysis);
    static const double to_usual = 1e-9; /* N/(mm um) */
    fprintf(stream, "Mesh %s of %s, quasi-static, contact ratio %.4g, %d positions over %d pitch%s\n\n",
            analysis->of_case->description->meshes[plan->mesh], analysis->of_case->path,
            number_of(analysis, 0, "contact_ratio"), plan->n_positions, plan->n_pitches,
            plan->n_pitches == 1 ? "" : "es, until the same teeth meet again");
    if (plan->speed != 0.0) {
        fprintf(stream, "Friction: sliding speeds of a driving wheel at %.5g rad/s.\n\n", plan->speed);
    }
    if (!is_compliant(analysis)) {
        const bool is_internal =
            number_of(analysis, 0, "base_radius_driving") * number_of(analysis, 0, "base_radius_driven") < 0;
        fputs(is_internal
                  ? "Only the contacts are compliant; compliant teeth are not available for an internal pair.\n\n"
                  : "Only the contacts are compliant. Compliant teeth and bodies make a mesh 2.5 to 3.5 times "
                    "softer; add\ncompliance: {} to both wheels, docs/guides/static_analysis.md.\n\n",
              stream);
    }
    print_head(stream);
    for (int i = 0; i < analysis->n_torques; i++) {
        print_row(stream, analysis, i);
    }
    fprintf(stream, "\nSingle tooth pair at the pitch point: %.4g N/(mm um) under %.5g N m.\n",
            number_of(analysis, last, "pair_stiffness_per_width") * to_usual, analysis->torques[last]);
    const double iso = number_of(analysis, last, "iso_pair_stiffness_per_width");
    if (!isnan(iso)) {
        fprintf(
            stream,
            "ISO 6336-1 (measured tooth pairs without body, a different quantity): c' %.4g, c_gamma %.4g N/(mm um).\n",
            iso * to_usual, number_of(analysis, last, "iso_mesh_stiffness_per_width") * to_usual);
    }
    print_loss_factor(stream, analysis);
    print_edges(stream, analysis);
    print_softness(stream, analysis);
    print_pressures(stream, analysis);
    print_root_stress(stream, analysis);
}

/* ---- JSON ---- */

void static_print_json(FILE *stream, const static_analysis *analysis)
{
    json_writer writer = {.stream = stream};
    CLEANUP_FREE double *numbers = xcalloc((size_t)analysis->n_torques, sizeof *numbers);
    const static_plan *plan = &analysis->plan;
    json_open(&writer, NULL, '{');
    json_text(&writer, "case", analysis->of_case->path);
    json_text(&writer, "mesh", analysis->of_case->description->meshes[plan->mesh]);
    json_text(&writer, "file", analysis->path);
    json_integer(&writer, "positions", plan->n_positions);
    json_integer(&writer, "pitches", plan->n_pitches);
    json_numbers(&writer, "torque", analysis->n_torques, analysis->torques);
    for (int i = 0; i < plan->n_outputs; i++) {
        if (plan->outputs[i].dims[0] != '\0' || plan->outputs[i].count == 0) {
            continue;
        }
        if (plan->outputs[i].is_static) {
            json_number(&writer, plan->outputs[i].name, analysis->numbers[i]);
            continue;
        }
        for (int k = 0; k < analysis->n_torques; k++) {
            numbers[k] = analysis->numbers[k * plan->n_outputs + i];
        }
        json_numbers(&writer, plan->outputs[i].name, analysis->n_torques, numbers);
    }
    json_close(&writer, '}');
    fputc('\n', stream);
}
