#include "base/interrupt.h"
#include "base/log.h"
#include "base/memory.h"
#include "base/number.h"
#include "base/suggest.h"
#include "case/unit.h"
#include "commands/command.h"
#include "commands/result.h"
#include "commands/static_print.h"
#include "commands/warn.h"
#include "files/history.h"
#include "simulate/prepare.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { USUAL_POINTS = 200, MOST_POINTS = 100000, MOST_TORQUES = 1000 };

typedef struct {
    const char *output; /**< NULL: the case's name with -static.h5 in the current folder */
    const char *mesh;   /**< name or index; NULL: the first one */
    const char *torque; /**< FROM:TO:STEPS or one number; NULL: what the loads give */
    const char *speed;  /**< NULL: no friction */
    const char *points;
    option_values set;
    bool json, quiet;
} static_options;

/** Refuse an option. @return false */
static bool refuse_option(const char *option, const char *text, const char *why, evl_error *error)
{
    OWNED char *place = xasprintf("%s %s", option, text);
    return evl_error_set(error, EVL_EXIT_USAGE, place, "%s", why);
}

/** A whole number from 1 to `most`. */
static bool read_count(const char *text, int most, int *count)
{
    double value;
    const bool good =
        number_read(text, &value) == NUMBER_FINITE && value >= 1.0 && value <= most && value == floor(value);
    *count = good ? (int)value : 0;
    return good;
}

static bool find_mesh(const prepared_case *prepared, const char *text, int *mesh, evl_error *error)
{
    const description *description = case_description(prepared->file);
    double index;
    *mesh = 0;
    if (text == NULL) {
        return true;
    }
    for (int i = 0; i < description->n_meshes; i++) {
        if (strcmp(text, description->meshes[i]) == 0) {
            *mesh = i;
            return true;
        }
    }
    if (number_read(text, &index) == NUMBER_FINITE && index >= 0.0 && index < description->n_meshes &&
        index == floor(index)) {
        *mesh = (int)index;
        return true;
    }
    OWNED char *meant = suggest_phrase(text, description->n_meshes, description->meshes);
    OWNED char *why = xasprintf("the case has no such mesh%s", meant);
    return refuse_option("--mesh", text, why, error);
}

static const char HOW_TORQUES[] =
    "it must be FROM:TO:STEPS, two torques [N m] that grow and how many there are, from 2 to "
    "1000, such as 10:200:20 or '10 N m:0.2 kN m:20'; or one torque";

/** A torque of --torque. */
static bool read_torque(const char *option, const char *text, double *torque, evl_error *error)
{
    OWNED char *why = quantity_complaint(text, "N m", HOW_TORQUES, torque);
    return why == NULL || refuse_option("--torque", option, why, error);
}

/** Both ends of FROM:TO:STEPS. @param parts  its texts */
static bool read_ends(const char *option, char *const parts[3], double ends[2], int *n, evl_error *error)
{
    static const char one_flank[] =
        "torques above 0 press the drive flanks, those below 0 the coast flanks, 0 none: ask for either";
    static const char one_unit[] = "one of its torques has a unit and the other has none: give both a unit, or neither";
    double number = 0.0;
    if (!read_torque(option, parts[0], &ends[0], error) || !read_torque(option, parts[1], &ends[1], error)) {
        return false;
    }
    if ((number_read(parts[0], &number) == NUMBER_NONE) != (number_read(parts[1], &number) == NUMBER_NONE)) {
        return refuse_option("--torque", option, one_unit, error);
    }
    if (!(ends[1] > ends[0]) || !read_count(parts[2], MOST_TORQUES, n) || *n < 2) {
        return refuse_option("--torque", option, HOW_TORQUES, error);
    }
    return ends[0] > 0.0 || ends[1] < 0.0 || refuse_option("--torque", option, one_flank, error);
}

/** FROM:TO:STEPS, evenly from one to the other, or one torque.
 *  @param torques  room for MOST_TORQUES */
static bool read_torques(const char *text, double *torques, int *n, evl_error *error)
{
    OWNED char *copy = xstrdup(text);
    char *parts[3] = {copy, strchr(copy, ':'), NULL};
    double ends[2];
    for (int i = 1; i < 3 && parts[i] != NULL; i++) {
        *parts[i]++ = '\0';
        if (i < 2) {
            parts[i + 1] = strchr(parts[i], ':');
        }
    }
    *n = 1;
    if (parts[1] == NULL) {
        return read_torque(text, copy, &torques[0], error);
    }
    if (parts[2] == NULL) {
        return refuse_option("--torque", text, HOW_TORQUES, error);
    }
    if (!read_ends(text, parts, ends, n, error)) {
        return false;
    }
    for (int i = 0; i < *n; i++) {
        torques[i] = i == *n - 1 ? ends[1] : ends[0] + (ends[1] - ends[0]) * i / (*n - 1);
    }
    return true;
}

/* ---- the file ---- */

typedef struct {
    prepared_case prepared;
    static_plan plan;
    history *file;
    int n_torques;
    double torques[MOST_TORQUES];
    double *values;  /**< [n_values] of the last torque */
    double *numbers; /**< [n_torques][n_outputs] those of each torque, for the summary */
} analysis;

/** 0, 1, 2, ... times a step from the first on, a new array. */
static double *count_up(int n, double first, double step)
{
    double *numbers = xcalloc((size_t)n, sizeof *numbers);
    for (int i = 0; i < n; i++) {
        numbers[i] = first + i * step;
    }
    return numbers;
}

static bool create_file(analysis *a, const char *path, evl_error *error)
{
    const description *description = case_description(a->prepared.file);
    const static_plan *plan = &a->plan;
    OWNED char *warnings = prepare_warnings(&a->prepared, "\n"), *versions = result_versions();
    OWNED double *positions = count_up(plan->n_positions, 0.0, 1.0),
                 *pairs = count_up(plan->n_pairs, plan->first_pair, 1), *harmonics = count_up(plan->n_harmonics, 1, 1);
    for (int i = 0; i < plan->n_positions; i++) {
        positions[i] /= plan->points;
    }
    const history_coordinate coordinates[] = {
        {"position", "1", "x", "pitches from where tooth pair 0 is at the start of contact", false, plan->n_positions,
         positions},
        {"pair", "1", "j",
         "tooth pair by how many pitches it is ahead of the one that came last onto the path; -1: the next", true,
         plan->n_pairs, pairs},
        {"harmonic", "1", "n", "harmonic of the mesh frequency", true, plan->n_harmonics, harmonics},
    };
    const history_attribute attributes[] = {
        {"title", .text = description->title},
        {"case", .text = case_text(a->prepared.file)},
        {"mesh", .text = description->meshes[plan->mesh]},
        {"versions", .text = versions},
        {"warnings", .text = warnings},
        {"points", .integer = plan->points},
        {"pitches", .integer = plan->n_pitches},
        {"status", .text = "running"},
        {"status_message", .text = ""},
    };
    const history_layout layout = {
        .path = path,
        .kind = "static",
        .axis = {.name = "torque", .units = "N m", .symbol = "T_A", .long_name = "torque of the driving wheel"},
        .n_coordinates = sizeof coordinates / sizeof *coordinates,
        .coordinates = coordinates,
        .n_outputs = plan->n_outputs,
        .outputs = plan->outputs,
        .max_rows = a->n_torques,
        .n_attributes = sizeof attributes / sizeof *attributes,
        .attributes = attributes,
    };
    a->file = history_create(&layout, error);
    return a->file != NULL;
}

/** What it came to: the file gets its name, or stays a .partial that says why. */
static void close_file(analysis *a, const char *path, evl_error *error)
{
    const bool is_done = error->code == EVL_EXIT_OK;
    OWNED char *partial = xstrdup(history_partial_path(a->file)), *reason = xstrdup(error->message);
    const history_attribute attributes[] = {
        {"status", .text = is_done                               ? "done"
                           : error->code == EVL_EXIT_INTERRUPTED ? "interrupted"
                                                                 : "failed"},
        {"status_message", .text = is_done ? "" : reason},
    };
    if (!history_close(&a->file, is_done, sizeof attributes / sizeof *attributes, attributes, error)) {
        return;
    }
    if (is_done) {
        log_note("%d position%s, %d torque%s: %s", a->plan.n_positions, a->plan.n_positions == 1 ? "" : "s",
                 a->n_torques, a->n_torques == 1 ? "" : "s", path);
    } else {
        OWNED char *place = xstrdup(error->place);
        evl_error_set(error, error->code, place, "%s; the torques before it are in '%s'", reason, partial);
    }
}

/* ---- the analysis ---- */

/** Turn a refusal of what was asked for into one of the option, another one into one of the case. @return false */
static bool refuse(const analysis *a, const model_message *refusal, const char *option, const char *text,
                   evl_error *error)
{
    return model_is_of_request(refusal) && text != NULL ? refuse_option(option, text, refusal->message, error)
                                                        : prepare_refuse(&a->prepared, refusal, error);
}

/** One torque; its numbers are kept for the summary. */
static bool solve(analysis *a, int i, const char *asked, evl_error *error)
{
    model_message refusal;
    if (!model_static(a->prepared.model, &a->plan, a->torques[i], a->values, &refusal)) {
        return refuse(a, &refusal, "--torque", asked, error);
    }
    for (int k = 0; k < a->plan.n_outputs; k++) {
        a->numbers[i * a->plan.n_outputs + k] = a->values[a->plan.outputs[k].offset];
    }
    return true;
}

/** All torques onto the file, which is made when the first one is known. */
static void analyse(analysis *a, const char *path, const char *asked, evl_error *error)
{
    if (!solve(a, 0, asked, error) || !create_file(a, path, error)) {
        return;
    }
    for (int i = 0; i < a->n_torques && error->code == EVL_EXIT_OK; i++) {
        if (interrupt_signal != 0) {
            evl_error_set(error, EVL_EXIT_INTERRUPTED, case_path(a->prepared.file), "interrupted by %s",
                          interrupt_name((int)interrupt_signal));
        } else if ((i == 0 || solve(a, i, asked, error)) && !history_append(a->file, a->torques[i], a->values, error)) {
            history_abandon(&a->file);
            return;
        }
    }
    close_file(a, path, error);
}

/** Torques to look at: those of the option, or the one that the loads give. */
static bool find_torques(analysis *a, const char *asked, evl_error *error)
{
    if (asked != NULL) {
        return read_torques(asked, a->torques, &a->n_torques, error);
    }
    a->n_torques = 1;
    a->torques[0] = a->plan.torque;
    return a->plan.torque > 0.0 ||
           evl_error_set(error, EVL_EXIT_CASE, case_path(a->prepared.file),
                         "its loads put no torque on mesh %s: give one with --torque, such as --torque 50",
                         case_description(a->prepared.file)->meshes[a->plan.mesh]);
}

static void analyse_case(analysis *a, const static_options *options, int points, const char *path, evl_error *error)
{
    int mesh;
    model_message refusal;
    if (!find_mesh(&a->prepared, options->mesh, &mesh, error)) {
        return;
    }
    if (!model_plan_static(a->prepared.model, mesh, points, &a->plan, &refusal)) {
        refuse(a, &refusal, "--points", options->points == NULL ? "" : options->points, error);
        return;
    }
    static const char must[] = "it must be a speed of the driving wheel [rad/s]";
    OWNED char *why = options->speed == NULL ? NULL : quantity_complaint(options->speed, "rad/s", must, &a->plan.speed);
    if (why != NULL) {
        refuse_option("--speed", options->speed, why, error);
        return;
    }
    if (find_torques(a, options->torque, error)) {
        a->values = xcalloc((size_t)a->plan.n_values, sizeof *a->values);
        a->numbers = xcalloc((size_t)a->n_torques * (size_t)a->plan.n_outputs, sizeof *a->numbers);
        warn_of_case(&a->prepared);
        analyse(a, path, options->torque, error);
    }
    evl_output compliance[EVL_MOST_QUANTITIES];
    if (error->code == EVL_EXIT_OK && (options->json || !options->quiet)) {
        const static_report report = {.file = a->prepared.file,
                                      .plan = &a->plan,
                                      .path = path,
                                      .gives_way =
                                          model_geometry(a->prepared.model, EVL_OF_COMPLIANCE, mesh, compliance) > 0,
                                      .n_torques = a->n_torques,
                                      .torques = a->torques,
                                      .numbers = a->numbers};
        (options->json ? static_print_json : static_print_text)(stdout, &report);
    }
    free(a->values);
    free(a->numbers);
}

static evl_exit run_static(const char *file, const void *given, evl_error *error)
{
    const static_options *options = given;
    int points = USUAL_POINTS;
    log_set_quiet(options->quiet);
    interrupt_install();
    if (options->points != NULL && !read_count(options->points, MOST_POINTS, &points)) {
        refuse_option("--points", options->points, "it must be a whole number of positions a pitch, from 21 to 100000",
                      error);
        return error->code;
    }
    OWNED analysis *a = xcalloc(1, sizeof *a);
    OWNED char *path = result_path("result", options->output, file, "-static", error);
    if (path != NULL && prepare_case(&a->prepared, file, options->set.n, options->set.values, error)) {
        analyse_case(a, options, points, path, error);
    }
    static_plan_free(&a->plan);
    prepared_case_free(&a->prepared);
    return error->code;
}

static const option_row rows[] = {
    {OPTION_TEXT, 0, "--mesh", "NAME", offsetof(static_options, mesh),
     "mesh to look at, by name or index; the first one if not given"},
    {OPTION_TEXT, 0, "--torque", "FROM:TO:STEPS", offsetof(static_options, torque),
     "torques of the driving wheel [N m], or with their units, or one, below 0 on the coast flanks; what the loads "
     "give if not given"},
    {OPTION_TEXT, 0, "--speed", "SPEED", offsetof(static_options, speed),
     "speed of the driving wheel [rad/s], or such as '1500 rpm', at which flanks rub as the mesh's friction says; "
     "without friction if not "
     "given"},
    {OPTION_TEXT, 0, "--points", "N", offsetof(static_options, points), "positions over a pitch; 200 if not given"},
    {OPTION_TEXT, 'o', "--output", "FILE.h5", offsetof(static_options, output),
     "file to write; the case's name with -static.h5 in the current folder if not given"},
    OPTION_ROW_SET(static_options),
    OPTION_ROW_JSON(static_options),
    OPTION_ROW_QUIET(static_options),
    OPTION_ROW_HELP,
};

const command static_command = {
    .name = "static",
    .synopsis = "CASE.yaml [--mesh NAME] [--torque FROM:TO:STEPS] [--speed SPEED] [--points N] [-o FILE.h5] [--set "
                "PATH=VALUE]... "
                "[--json] [-q]",
    .summary = "find transmission error, stiffness and load sharing of a mesh at rest",
    .text =
        "Puts one mesh of the case under a torque of its driving wheel, at rest, at positions over a pitch, and finds "
        "its\n"
        "transmission error, its stiffness, the forces and pressures of its tooth pairs; with --torque for many "
        "torques. Where\n"
        "errors of pitch or runout make teeth differ, positions go on until the same teeth meet again. Axles are at "
        "their\n"
        "reference positions. Torques below 0 press the coast flanks. With --speed the flanks rub as if the wheels "
        "turned "
        "so,\n"
        "in the sense of driving_rotation, or against it below 0. Writes an HDF5 file that netCDF-4 readers open, and "
        "prints\n"
        "a summary.\n"
        "\n"
        "Examples:\n"
        "  evolvent static examples/compliant-pair.yaml\n"
        "  evolvent static examples/compliant-pair.yaml --torque 10:200:20 -o harris.h5\n"
        "  evolvent static examples/two-stage-gears.yaml --mesh 1 --points 100\n",
    .file = "case file",
    .size = sizeof(static_options),
    OPTION_ROWS(rows),
    .run = run_static,
};
