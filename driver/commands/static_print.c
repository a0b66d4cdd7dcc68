#include "commands/static_print.h"

#include "base/json.h"
#include "base/memory.h"

#include <math.h>
#include <string.h>

/** A result for a torque, in the unit of the output. */
static double number_of(const static_report *report, int torque, const char *output)
{
    const static_plan *plan = report->plan;
    int i = 0;
    while (i < plan->n_outputs && strcmp(plan->outputs[i].name, output) != 0) {
        i++;
    }
    return i < plan->n_outputs ? report->numbers[torque * plan->n_outputs + i] : NAN;
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
    {"largest_edge_force", {"largest", "force of", "an edge"}, "N", 1.0},
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

static void print_row(FILE *stream, const static_report *report, int torque)
{
    fprintf(stream, "  %*.*g", WIDTH - 2, DIGITS + 1, report->torques[torque]);
    for (int i = 0; i < N_COLUMNS; i++) {
        fprintf(stream, "  %*.*g", WIDTH, DIGITS, number_of(report, torque, columns[i].output) * columns[i].factor);
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
static void print_edges(FILE *stream, const static_report *report)
{
    double force = 0;
    for (int i = 0; i < report->n_torques; i++) {
        force = fmax(force, number_of(report, i, "sharp_edge_force"));
    }
    if (force > 0) {
        fprintf(stream,
                "Largest pressure without corner contact: no rounding given, pressure undefined, force up to %.3g kN.\n"
                "'tip_rounding' of the wheels gives one, docs/theory/compliant_flanks.md.\n",
                force * 1e-3);
    }
}

/** Compare the mean stiffness at the last torque with ISO 6336-1, for compliant teeth and gear bodies. */
static void print_softness(FILE *stream, const static_report *report)
{
    static const double low = 0.8; /* relative to c_gamma */
    const int last = report->n_torques - 1;
    const double ratio =
        number_of(report, last, "mesh_stiffness_per_width") / number_of(report, last, "iso_mesh_stiffness_per_width");
    if (report->is_compliant && ratio < low) {
        fprintf(stream,
                "The mean stiffness is %.2g of c_gamma: the bodies are compliant down to hub_diameter, by default the "
                "bore;\ngive both wheels the diameter of the stiff shaft or hub, docs/theory/compliance.md.\n",
                ratio);
    }
}

/** Print the loss factor of equal shares beside that of the shares under load. */
static void print_loss_factor(FILE *stream, const static_report *report)
{
    const int last = report->n_torques - 1;
    const double equal = number_of(report, 0, "tooth_loss_factor");
    fputs("Tooth loss factor: H_V ", stream);
    if (isnan(equal)) {
        fputs("not defined for this path of contact", stream);
    } else {
        fprintf(stream, "%.4g with equal load shares", equal);
    }
    fprintf(stream, ", H_VL %.4g with the shares under %.5g N m, corner contact included.\n",
            number_of(report, last, "loaded_tooth_loss_factor"), report->torques[last]);
}

/** Print the contact pressure at points of the path, and its maximum. */
static void print_pressures(FILE *stream, const static_report *report)
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
    for (int torque = 0; torque < report->n_torques; torque++) {
        for (int row = 0; row < 2; row++) {
            fprintf(stream, "  %-12s  %*.*g", rows[row][1], WIDTH - 2, DIGITS + 1, report->torques[torque]);
            for (int i = 0; i < 5; i++) {
                CLEANUP_FREE char *name = xasprintf("%s%s", rows[row][0], points[i]);
                print_stress(stream, number_of(report, torque, name));
            }
            if (row == 0) {
                print_stress(stream, number_of(report, torque, "largest_contact_pressure"));
                print_corner(stream, number_of(report, torque, "sharp_edge_force"));
            }
            fputc('\n', stream);
        }
    }
}

/** Print the extremes of the root stress with their teeth and arcs. */
static void print_root_stress(FILE *stream, const static_report *report)
{
    static const char *const wheels[] = {"driving", "driven"}, *const extremes[] = {"max", "min"};
    static const struct {
        const char *name, *head, *unit;
        double factor;
    } values[] = {{"", "", "MPa", 1e-6},
                  {"_x", "position", "pitches", 1},
                  {"_tooth", "tooth", "", 1},
                  {"_arc", "arc", "mm", 1e3}};
    if (report->plan->n_wheels == 0) {
        if (report->is_compliant) {
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
        if (isnan(number_of(report, 0, largest))) {
            fprintf(stream, "No root stress of the %s wheel: it has no compliance by finite elements.\n",
                    wheels[wheel]);
            continue;
        }
        for (int torque = 0; torque < report->n_torques; torque++) {
            fprintf(stream, "  %*s  %*.*g", WIDTH - 2, wheels[wheel], WIDTH - 2, DIGITS + 1, report->torques[torque]);
            for (int i = 0; i < 8; i++) {
                CLEANUP_FREE char *name =
                    xasprintf("root_stress_%s%s_%s", extremes[i / 4], values[i % 4].name, wheels[wheel]);
                fprintf(stream, "  %*.*g", POINT_WIDTH, DIGITS, number_of(report, torque, name) * values[i % 4].factor);
            }
            fputc('\n', stream);
        }
    }
    fputs("Uniform stress over the face width (K_Fbeta = K_Hbeta = 1), no friction along the flank.\n", stream);
}

void static_print_text(FILE *stream, const static_report *report)
{
    const static_plan *plan = report->plan;
    const int last = report->n_torques - 1;
    static const double to_usual = 1e-9; /* N/(mm um) */
    fprintf(stream, "Mesh %s of %s, quasi-static, contact ratio %.4g, %d positions over %d pitch%s\n\n",
            case_description(report->file)->meshes[plan->mesh], case_path(report->file),
            number_of(report, 0, "contact_ratio"), plan->n_positions, plan->n_pitches,
            plan->n_pitches == 1 ? "" : "es, until the same teeth meet again");
    if (plan->speed != 0.0) {
        fprintf(stream, "Friction: sliding speeds of a driving wheel at %.5g rad/s.\n\n", plan->speed);
    }
    if (!report->is_compliant) {
        const bool is_internal =
            number_of(report, 0, "base_radius_driving") * number_of(report, 0, "base_radius_driven") < 0;
        fputs(is_internal
                  ? "Only the contacts are compliant; compliant teeth are not available for an internal pair.\n\n"
                  : "Only the contacts are compliant. Compliant teeth and bodies make a mesh 2.5 to 3.5 times "
                    "softer; add\ncompliance: {} to both wheels, docs/guides/static_analysis.md.\n\n",
              stream);
    }
    print_head(stream);
    for (int i = 0; i < report->n_torques; i++) {
        print_row(stream, report, i);
    }
    fprintf(stream, "\nSingle tooth pair at the pitch point: %.4g N/(mm um) under %.5g N m.\n",
            number_of(report, last, "pair_stiffness_per_width") * to_usual, report->torques[last]);
    const double iso = number_of(report, last, "iso_pair_stiffness_per_width");
    if (!isnan(iso)) {
        fprintf(
            stream,
            "ISO 6336-1 (measured tooth pairs without body, a different quantity): c' %.4g, c_gamma %.4g N/(mm um).\n",
            iso * to_usual, number_of(report, last, "iso_mesh_stiffness_per_width") * to_usual);
    }
    print_loss_factor(stream, report);
    print_edges(stream, report);
    print_softness(stream, report);
    print_pressures(stream, report);
    print_root_stress(stream, report);
}

/* ---- JSON ---- */

void static_print_json(FILE *stream, const static_report *report)
{
    json_writer writer = {.stream = stream};
    CLEANUP_FREE double *numbers = xcalloc((size_t)report->n_torques, sizeof *numbers);
    const static_plan *plan = report->plan;
    json_open(&writer, NULL, '{');
    json_text(&writer, "case", case_path(report->file));
    json_text(&writer, "mesh", case_description(report->file)->meshes[plan->mesh]);
    json_text(&writer, "file", report->path);
    json_integer(&writer, "positions", plan->n_positions);
    json_integer(&writer, "pitches", plan->n_pitches);
    json_numbers(&writer, "torque", report->n_torques, report->torques);
    for (int i = 0; i < plan->n_outputs; i++) {
        if (plan->outputs[i].dims[0] != '\0' || plan->outputs[i].count == 0) {
            continue;
        }
        if (plan->outputs[i].is_static) {
            json_number(&writer, plan->outputs[i].name, report->numbers[i]);
            continue;
        }
        for (int k = 0; k < report->n_torques; k++) {
            numbers[k] = report->numbers[k * plan->n_outputs + i];
        }
        json_numbers(&writer, plan->outputs[i].name, report->n_torques, numbers);
    }
    json_close(&writer, '}');
    fputc('\n', stream);
}
