#include "analyses/modes_print.h"

#include "base/json.h"
#include "base/words.h"

#include <math.h>
#include <string.h>

static const double PI = 3.14159265358979323846;
static const char *const contacts[] = {[EVL_CONTACT_OPEN] = "open",
                                       [EVL_CONTACT_LOADED] = "loaded",
                                       [EVL_CONTACT_UNLOADED] = "unloaded",
                                       [EVL_CONTACT_APART] = "apart"};

/** An output at the state; `part` is the index of the wheel or mesh. */
static double value_of(const modes_report *report, const char *output, int part)
{
    return report->values[model_output_offset(report->plan->model, output) + part];
}

static bool is_oscillation(const natural_mode *mode)
{
    return cimag(mode->eigenvalue) > 0.0;
}

/** |lambda|/(2 pi) [Hz]; NaN for a mode that does not oscillate. Equation M2. */
static double natural_frequency(const natural_mode *mode)
{
    return is_oscillation(mode) ? cabs(mode->eigenvalue) / (2.0 * PI) : NAN;
}

/** NaN for a mode that does not oscillate. Equation M4. */
static double damping_ratio(const natural_mode *mode)
{
    return is_oscillation(mode) ? -creal(mode->eigenvalue) / cabs(mode->eigenvalue) : NAN;
}

/** Time to decay to 1/e [s]; negative if it grows. Infinite without damping. Equation M5. */
static double time_constant(const natural_mode *mode)
{
    return -1.0 / creal(mode->eigenvalue);
}

/* ---- tables ---- */

/* Damping ratios below it are rounding errors. */
static const double no_damping = 1e-12;

static int name_width(const description *description)
{
    int width = (int)strlen("wheel");
    for (int i = 0; i < description->n_wheels; i++) {
        width = words_width(width, description->wheels[i]);
    }
    for (int i = 0; i < description->n_meshes; i++) {
        width = words_width(width, description->meshes[i]);
    }
    return width;
}

/** A number in a column, or a dash if there is none. */
static void print_cell(FILE *stream, int width, int digits, double value)
{
    if (isfinite(value)) {
        fprintf(stream, "  %*.*g", width, digits, value);
    } else {
        fprintf(stream, "  %*s", width, "-");
    }
}

/** Print which state it is. */
static void print_what(FILE *stream, const modes_report *report)
{
    fprintf(stream, "Case %s, linearised ", report->plan->path);
    switch (report->kind) {
    case MODES_AT:
        fprintf(stream, "at t = %.9g s\n\n", report->state.t);
        break;
    case MODES_MEAN:
        fputs("with the mean over one pitch of its steady states under load\n\n", stream);
        break;
    case MODES_STEADY:
        fputs("at its steady state under load\n", stream);
        if (!isnan(report->mesh_position)) {
            fprintf(stream, "The first mesh in the power flow is %.9g pitches from the start of contact\n",
                    report->mesh_position);
        }
        fputc('\n', stream);
        break;
    }
}

static void print_mesh(FILE *stream, const modes_report *report, int mesh, int width)
{
    const evl_mesh_mode standing = model_mesh_mode(report->plan->model, &report->state, mesh);
    const bool is_mean = report->kind == MODES_MEAN;
    fprintf(stream, "  %-*s  %9s", width, report->plan->description->meshes[mesh],
            is_mean ? "mean" : contacts[standing.contact]);
    print_cell(stream, 8, 4, is_mean ? NAN : standing.position);
    print_cell(stream, 5, 4, value_of(report, "pairs_in_contact", mesh));
    print_cell(stream, 15, 6, value_of(report, "penetration", mesh));
    print_cell(stream, 16, 6, value_of(report, "normal_force", mesh));
    print_cell(stream, 15, 1, is_mean ? (double)NAN : (double)standing.friction);
    print_cell(stream, 14, 6, value_of(report, "sliding_velocity", mesh));
    fputc('\n', stream);
}

static void print_state(FILE *stream, const modes_report *report)
{
    const description *description = report->plan->description;
    const int width = name_width(description);
    print_what(stream, report);
    fprintf(stream, "  %-*s  %14s\n", width, "wheel", "speed [rad/s]");
    for (int i = 0; i < description->n_wheels; i++) {
        fprintf(stream, "  %-*s  %14.6g\n", width, description->wheels[i], value_of(report, "angular_velocity", i));
    }
    fprintf(stream, "\n  %-*s  %9s  %8s  %5s  %15s  %16s  %15s  %14s\n", width, "mesh", "contact", "position", "pairs",
            "penetration [m]", "normal force [N]", "friction branch", "sliding [m/s]");
    for (int i = 0; i < description->n_meshes; i++) {
        print_mesh(stream, report, i, width);
    }
}

enum { LABEL_SIZE = 16 };

/** Index, from 1, of a mode among the oscillatory ones, or among the others. */
static int number_of(const natural_modes *modes, int index)
{
    int number = 0;
    for (int i = 0; i <= index; i++) {
        number += is_oscillation(&modes->modes[i]) == is_oscillation(&modes->modes[index]);
    }
    return number;
}

/** "1", or "d1" for a mode that decays without oscillation. */
static void write_label(const natural_modes *modes, int index, char label[LABEL_SIZE])
{
    const char *kind = is_oscillation(&modes->modes[index]) ? "" : "d";
    (void)snprintf(label, LABEL_SIZE, "%s%d", kind, number_of(modes, index));
}

static void print_frequencies(FILE *stream, const natural_modes *modes)
{
    bool grows = false, decays = false;
    fprintf(stream, "\n  %4s  %22s  %13s  %17s  %s\n", "mode", "natural frequency [Hz]", "damping ratio",
            "time constant [s]", "eigenvalue [1/s]");
    for (int i = 0; i < modes->n; i++) {
        const natural_mode *mode = &modes->modes[i];
        const double complex lambda = mode->eigenvalue;
        const bool is_damped = fabs(creal(lambda)) > no_damping * cabs(lambda);
        char label[LABEL_SIZE];
        write_label(modes, i, label);
        fprintf(stream, "  %4s", label);
        print_cell(stream, 22, 6, natural_frequency(mode));
        print_cell(stream, 13, 4, is_damped ? damping_ratio(mode) : is_oscillation(mode) ? 0.0 : NAN);
        print_cell(stream, 17, 4, is_damped ? time_constant(mode) : NAN);
        fprintf(stream, "  %.6g", is_damped ? creal(lambda) : 0.0);
        if (is_oscillation(mode)) {
            fprintf(stream, " +- %.6gi", cimag(lambda));
        }
        fputc('\n', stream);
        decays = decays || !is_oscillation(mode);
        grows = grows || (is_damped && creal(lambda) > 0.0);
    }
    if (modes->n == 0) {
        fputs("  none\n", stream);
    }
    if (modes->n_rigid == 0) {
        fputs("\n  There is no rigid-body mode.\n", stream);
    } else {
        fprintf(stream, "\n  %d rigid-body mode%s (no restoring force) %s not listed.\n", modes->n_rigid,
                modes->n_rigid == 1 ? "" : "s", modes->n_rigid == 1 ? "is" : "are");
    }
    if (decays) {
        fputs("  Modes d1, d2, ... do not oscillate.\n", stream);
    }
    if (grows) {
        fputs("  Modes with a negative time constant grow: this state is unstable.\n", stream);
    }
}

static void print_coordinate(FILE *stream, int width, const char *name, const char *what, double complex value)
{
    const double amplitude = cabs(value);
    fprintf(stream, amplitude >= 1e-3 || amplitude == 0.0 ? "  %-*s  %-28s  %9.4f" : "  %-*s  %-28s  %9.2e", width,
            name, what, amplitude);
    if (amplitude > 0.0) {
        const double phase = carg(value) * 180.0 / PI;
        fprintf(stream, "  %11.1f", fabs(phase) < 0.05 ? 0.0 : phase < -179.95 ? 180.0 : phase);
    }
    fputc('\n', stream);
}

static void print_wheel(FILE *stream, int width, const modes_report *report, int index, const natural_mode *mode)
{
    const char *name = report->plan->description->wheels[index];
    const double complex *displacement = mode->displacements[index];
    print_coordinate(stream, width, name, value_of(report, "teeth", index) != 0 ? "rotation r_b phi" : "rotation r phi",
                     mode->arcs[index]);
    double directions[2][2];
    const int n = model_support_directions(report->plan->model, index, directions);
    if (n == 1) {
        print_coordinate(stream, width, "", "displacement of the slider",
                         displacement[0] * directions[0][0] + displacement[1] * directions[0][1]);
    } else if (n == 2) {
        print_coordinate(stream, width, "", "displacement x", displacement[0]);
        print_coordinate(stream, width, "", "displacement y", displacement[1]);
    }
}

static void print_shapes(FILE *stream, const modes_report *report)
{
    const description *description = report->plan->description;
    const int width = name_width(description);
    if (report->modes.n > 0) {
        fputs("\nMode shapes, as lengths: the largest motion of a wheel or axle is 1; rotations are positive "
              "counterclockwise,\n"
              "as arcs of the base circle, or of the rim of a disc.\n",
              stream);
    }
    for (int k = 0; k < report->modes.n; k++) {
        const natural_mode *mode = &report->modes.modes[k];
        char label[LABEL_SIZE], title[LABEL_SIZE + sizeof "mode "];
        write_label(&report->modes, k, label);
        (void)snprintf(title, sizeof title, "mode %s", label);
        fprintf(stream, "\n  %-*s  %-28s  %9s  %11s\n", width, title, "", "amplitude", "phase [deg]");
        for (int i = 0; i < description->n_wheels; i++) {
            print_wheel(stream, width, report, i, mode);
        }
        for (int i = 0; i < description->n_meshes; i++) {
            print_coordinate(stream, width, description->meshes[i], "penetration h", mode->penetrations[i]);
            print_coordinate(stream, width, "", "transmission error Delta", mode->transmission_errors[i]);
        }
    }
}

void modes_print_text(FILE *stream, const modes_report *report)
{
    print_state(stream, report);
    print_frequencies(stream, &report->modes);
    print_shapes(stream, report);
}

/* ---- JSON ---- */

static void write_complex(json_writer *writer, const char *key, double complex value)
{
    const double parts[] = {creal(value) + 0.0, cimag(value) + 0.0}; /* no negative zeros */
    json_numbers(writer, key, 2, parts);
}

static void write_state(json_writer *writer, const modes_report *report)
{
    const description *description = report->plan->description;
    json_open(writer, "state", '{');
    static const char *const kinds[] = {[MODES_STEADY] = "steady", [MODES_MEAN] = "mean", [MODES_AT] = "at"};
    const bool is_mean = report->kind == MODES_MEAN;
    json_text(writer, "kind", kinds[report->kind]);
    json_number(writer, "time", report->state.t);
    json_number(writer, "mesh_position", report->kind == MODES_STEADY ? report->mesh_position : NAN);
    json_open(writer, "wheels", '{');
    for (int i = 0; i < description->n_wheels; i++) {
        json_open(writer, description->wheels[i], '{');
        json_number(writer, "angular_velocity", value_of(report, "angular_velocity", i));
        json_close(writer, '}');
    }
    json_close(writer, '}');
    json_open(writer, "meshes", '{');
    for (int i = 0; i < description->n_meshes; i++) {
        const evl_mesh_mode standing = model_mesh_mode(report->plan->model, &report->state, i);
        json_open(writer, description->meshes[i], '{');
        json_text(writer, "contact", is_mean ? "mean" : contacts[standing.contact]);
        json_number(writer, "position", is_mean ? NAN : standing.position);
        json_number(writer, "pairs_in_contact", value_of(report, "pairs_in_contact", i));
        json_number(writer, "friction_branch", is_mean ? (double)NAN : (double)standing.friction);
        json_number(writer, "tooth_pair", is_mean ? (double)NAN : (double)standing.tooth_pair);
        json_number(writer, "penetration", value_of(report, "penetration", i));
        json_number(writer, "normal_force", value_of(report, "normal_force", i));
        json_number(writer, "sliding_velocity", value_of(report, "sliding_velocity", i));
        json_close(writer, '}');
    }
    json_close(writer, '}');
    json_close(writer, '}');
}

static void write_mode(json_writer *writer, const description *description, const natural_modes *modes, int index)
{
    const natural_mode *mode = &modes->modes[index];
    json_open(writer, NULL, '{');
    json_number(writer, "number", is_oscillation(mode) ? (double)number_of(modes, index) : (double)NAN);
    write_complex(writer, "eigenvalue", mode->eigenvalue);
    json_number(writer, "natural_frequency", natural_frequency(mode));
    json_number(writer, "damped_frequency", is_oscillation(mode) ? cimag(mode->eigenvalue) / (2.0 * PI) : NAN);
    json_number(writer, "damping_ratio", damping_ratio(mode));
    json_number(writer, "time_constant", time_constant(mode));
    json_open(writer, "wheels", '{');
    for (int i = 0; i < description->n_wheels; i++) {
        json_open(writer, description->wheels[i], '{');
        write_complex(writer, "arc", mode->arcs[i]);
        write_complex(writer, "displacement_x", mode->displacements[i][0]);
        write_complex(writer, "displacement_y", mode->displacements[i][1]);
        json_close(writer, '}');
    }
    json_close(writer, '}');
    json_open(writer, "meshes", '{');
    for (int i = 0; i < description->n_meshes; i++) {
        json_open(writer, description->meshes[i], '{');
        write_complex(writer, "penetration", mode->penetrations[i]);
        write_complex(writer, "transmission_error", mode->transmission_errors[i]);
        json_close(writer, '}');
    }
    json_close(writer, '}');
    json_close(writer, '}');
}

void modes_print_json(FILE *stream, const modes_report *report)
{
    json_writer writer = {.stream = stream};
    json_open(&writer, NULL, '{');
    json_text(&writer, "path", report->plan->path);
    write_state(&writer, report);
    json_number(&writer, "rigid_body_modes", report->modes.n_rigid);
    json_open(&writer, "modes", '[');
    for (int i = 0; i < report->modes.n; i++) {
        write_mode(&writer, report->plan->description, &report->modes, i);
    }
    json_close(&writer, ']');
    json_close(&writer, '}');
}
