#include "analyses/static_analysis.h"

#include "analyses/find_mesh.h"
#include "analyses/versions.h"
#include "base/memory.h"
#include "base/number.h"
#include "case/unit.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { USUAL_POINTS = 200, MOST_POINTS = 100000 };

/** Refuse an option. @return false */
static bool refuse_option(const char *option, const char *text, const char *why, evl_error *error)
{
    CLEANUP_FREE char *location = xasprintf("%s %s", option, text);
    return evl_error_set(error, EVL_EXIT_USAGE, location, "%s", why);
}

/** Read an integer from 1 to `most`. */
static bool read_count(const char *text, int most, int *count)
{
    double value;
    const bool good =
        number_read(text, &value) == NUMBER_FINITE && value >= 1.0 && value <= most && value == floor(value);
    *count = good ? (int)value : 0;
    return good;
}

static const char HOW_TORQUES[] = "it must be FROM:TO:STEPS, two increasing torques [N m] and their number from 2 to "
                                  "1000, such as 10:200:20 or '10 N m:0.2 kN m:20'; or one torque";

/** Read a torque of --torque. */
static bool read_torque(const char *option, const char *text, double *torque, evl_error *error)
{
    CLEANUP_FREE char *why = quantity_complaint(text, "N m", HOW_TORQUES, torque);
    return why == NULL || refuse_option("--torque", option, why, error);
}

/** Read both ends of FROM:TO:STEPS. @param parts  its texts */
static bool read_ends(const char *option, char *const parts[3], double ends[2], int *n, evl_error *error)
{
    static const char one_flank[] = "torques above 0 load the drive flanks, those below 0 the coast flanks, and 0 "
                                    "loads none; give torques of one sign";
    static const char one_unit[] = "one of its torques has a unit and the other has none; give both a unit, or neither";
    double number = 0.0;
    if (!read_torque(option, parts[0], &ends[0], error) || !read_torque(option, parts[1], &ends[1], error)) {
        return false;
    }
    if ((number_read(parts[0], &number) == NUMBER_NONE) != (number_read(parts[1], &number) == NUMBER_NONE)) {
        return refuse_option("--torque", option, one_unit, error);
    }
    if (!(ends[1] > ends[0]) || !read_count(parts[2], STATIC_MOST_TORQUES, n) || *n < 2) {
        return refuse_option("--torque", option, HOW_TORQUES, error);
    }
    return ends[0] > 0.0 || ends[1] < 0.0 || refuse_option("--torque", option, one_flank, error);
}

/** Read FROM:TO:STEPS, evenly spaced, or one torque.
 *  @param torques  space for STATIC_MOST_TORQUES */
static bool read_torques(const char *text, double *torques, int *n, evl_error *error)
{
    CLEANUP_FREE char *copy = xstrdup(text);
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

/** Multiples 0, 1, 2, ... of a step added to the first number, a new array. */
static double *count_up(int n, double first, double step)
{
    double *numbers = xcalloc((size_t)n, sizeof *numbers);
    for (int i = 0; i < n; i++) {
        numbers[i] = first + i * step;
    }
    return numbers;
}

/** Names of the driving and the driven wheel. */
static void name_wheels(const static_analysis *a, const char *names[2])
{
    const model *model = a->of_case->model;
    const description *description = a->of_case->description;
    CLEANUP_FREE double *values = xcalloc((size_t)model_about(model)->n_values, sizeof *values);
    model_constants(model, values);
    names[0] = description->wheels[(int)model_output_value(model, values, "driving_wheel", a->plan.mesh)];
    names[1] = description->wheels[(int)model_output_value(model, values, "driven_wheel", a->plan.mesh)];
}

static bool create_file(static_analysis *a, evl_error *error)
{
    const description *description = a->of_case->description;
    const static_plan *plan = &a->plan;
    CLEANUP_FREE char *warnings = case_plan_warnings(a->of_case, NULL, "\n"), *versions = result_versions();
    CLEANUP_FREE double *positions = count_up(plan->n_positions, 0.0, 1.0),
                        *pairs = count_up(plan->n_pairs, plan->first_pair, 1),
                        *harmonics = count_up(plan->n_harmonics, 1, 1);
    for (int i = 0; i < plan->n_positions; i++) {
        positions[i] /= plan->points;
    }
    const char *wheels[2];
    name_wheels(a, wheels);
    const history_coordinate coordinates[] = {
        {"position", "1", "x", "position: pitches after the start of contact of tooth pair 0", false, plan->n_positions,
         positions, NULL},
        {"pair", "1", "j", "tooth pair: pitches ahead of the one that entered the path last; -1: the next one", true,
         plan->n_pairs, pairs, NULL},
        {"harmonic", "1", "n", "harmonic of the mesh frequency", true, plan->n_harmonics, harmonics, NULL},
        {"wheel", "1", "wheel", "wheel: driving, driven", false, plan->n_wheels, NULL, wheels},
    };
    const history_attribute attributes[] = {
        {"title", .text = description->title},
        {"case", .text = case_text(a->of_case->file)},
        {"mesh", .text = description->meshes[plan->mesh]},
        {"versions", .text = versions},
        {"warnings", .text = warnings},
        {"points", .integer = plan->points},
        {"pitches", .integer = plan->n_pitches},
        {"status", .text = "running"},
        {"status_message", .text = ""},
    };
    const history_layout layout = {
        .path = a->path,
        .in_memory = a->in_memory,
        .kind = "static",
        .axis = {.name = "torque", .units = "N m", .symbol = "T_A", .long_name = "torque of the driving wheel"},
        .n_coordinates = (int)(sizeof coordinates / sizeof *coordinates) - (plan->n_wheels == 0 ? 1 : 0),
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

/** Close the file: rename it if complete, else leave a .partial with the reason. */
static void close_file(static_analysis *a, evl_error *error)
{
    const bool is_done = error->code == EVL_EXIT_OK;
    CLEANUP_FREE char *partial = xstrdup(history_partial_path(a->file)), *reason = xstrdup(error->message);
    const history_attribute attributes[] = {
        {"status", .text = is_done                               ? "done"
                           : error->code == EVL_EXIT_INTERRUPTED ? "interrupted"
                                                                 : "failed"},
        {"status_message", .text = is_done ? "" : reason},
    };
    if (history_close(&a->file, is_done, sizeof attributes / sizeof *attributes, attributes, error) && !is_done &&
        partial[0] != '\0') {
        CLEANUP_FREE char *location = xstrdup(error->location);
        evl_error_set(error, error->code, location, "%s; the torques before it are in '%s'", reason, partial);
    }
}

/* ---- the analysis ---- */

/** Turn a refusal of the request into an error of the option, any other into one of the case. @return false */
static bool refuse(const static_analysis *a, const model_message *refusal, const char *option, const char *text,
                   evl_error *error)
{
    return model_is_of_request(refusal) && text != NULL ? refuse_option(option, text, refusal->message, error)
                                                        : case_plan_refuse(a->of_case, refusal, error);
}

/** Analyse one torque; its results are stored for the summary. */
static bool solve(static_analysis *a, int i, const char *asked, evl_error *error)
{
    model_message refusal;
    if (!model_static(a->of_case->model, &a->plan, a->torques[i], a->values, &refusal)) {
        return refuse(a, &refusal, "--torque", asked, error);
    }
    for (int k = 0; k < a->plan.n_outputs; k++) {
        const model_output *output = &a->plan.outputs[k];
        a->numbers[i * a->plan.n_outputs + k] = output->count > 0 ? a->values[output->offset] : NAN;
    }
    return true;
}

/** Analyse all torques and write the file, which is created after the first one. */
static void analyse(static_analysis *a, const static_request *request, evl_error *error)
{
    const char *asked = request->torque;
    if (!solve(a, 0, asked, error) || !create_file(a, error)) {
        return;
    }
    for (int i = 0; i < a->n_torques && error->code == EVL_EXIT_OK; i++) {
        if (*request->interrupt != 0) {
            evl_error_set(error, EVL_EXIT_INTERRUPTED, a->of_case->path, "interrupted by %s",
                          request->who(*request->interrupt));
        } else if ((i == 0 || solve(a, i, asked, error)) && !history_append(a->file, a->torques[i], a->values, error)) {
            history_abandon(&a->file);
            return;
        }
    }
    close_file(a, error);
}

/** Torques to analyse: those of the option, or the one from the loads. */
static bool find_torques(static_analysis *a, const char *asked, evl_error *error)
{
    if (asked != NULL) {
        return read_torques(asked, a->torques, &a->n_torques, error);
    }
    a->n_torques = 1;
    a->torques[0] = a->plan.torque;
    return fabs(a->plan.torque) > 0.0 ||
           evl_error_set(error, EVL_EXIT_CASE, a->of_case->path,
                         "its loads exert no torque on mesh %s; give one with --torque, such as --torque 50",
                         a->of_case->description->meshes[a->plan.mesh]);
}

bool static_check(const static_request *request, int *points, evl_error *error)
{
    *points = USUAL_POINTS;
    return request->points == NULL || read_count(request->points, MOST_POINTS, points) ||
           refuse_option("--points", request->points,
                         "it must be a whole number of positions a pitch, from 21 to 100000", error);
}

bool static_plan_case(static_analysis *a, const static_request *request, int points, evl_error *error)
{
    static const char must[] = "it must be a speed of the driving wheel [rad/s]";
    int mesh;
    model_message refusal;
    if (!find_mesh(a->of_case->description, request->mesh, &mesh, error)) {
        return false;
    }
    if (!model_plan_static(a->of_case->model, mesh, points, &a->plan, &refusal)) {
        return refuse(a, &refusal, "--points", request->points == NULL ? "" : request->points, error);
    }
    CLEANUP_FREE char *why =
        request->speed == NULL ? NULL : quantity_complaint(request->speed, "rad/s", must, &a->plan.speed);
    return why == NULL ? find_torques(a, request->torque, error) : refuse_option("--speed", request->speed, why, error);
}

bool static_analyse(static_analysis *a, const static_request *request, evl_error *error)
{
    a->values = xcalloc((size_t)a->plan.n_values, sizeof *a->values);
    a->numbers = xcalloc((size_t)a->n_torques * (size_t)a->plan.n_outputs, sizeof *a->numbers);
    analyse(a, request, error);
    return error->code == EVL_EXIT_OK;
}

void static_analysis_free(static_analysis *a)
{
    static_plan_free(&a->plan);
    free(a->values);
    free(a->numbers);
}
