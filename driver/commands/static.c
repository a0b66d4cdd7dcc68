#include "base/interrupt.h"
#include "base/log.h"
#include "base/memory.h"
#include "commands/cached_case.h"
#include "commands/command.h"
#include "commands/result.h"
#include "commands/static_print.h"
#include "commands/warn.h"

#include <stdlib.h>

typedef struct {
    const char *output; /**< NULL: the case's name with -static.h5 in the current folder */
    static_request request;
    option_values set;
    bool json, quiet;
} static_options;

static void analyse_case(static_analysis *a, const static_options *options, int points, evl_error *error)
{
    static_request request = options->request;
    request.interrupt = &interrupt_signal;
    request.who = interrupt_name;
    if (!static_plan_case(a, &request, points, error)) {
        return;
    }
    warn_of_case(a->of_case, NULL);
    if (static_analyse(a, &request, error)) {
        log_note("%d position%s, %d torque%s: %s", a->plan.n_positions, a->plan.n_positions == 1 ? "" : "s",
                 a->n_torques, a->n_torques == 1 ? "" : "s", a->path);
        if (options->json || !options->quiet) {
            (options->json ? static_print_json : static_print_text)(stdout, a);
        }
    }
}

static evl_exit run_static(const char *file, const void *given, evl_error *error)
{
    const static_options *options = given;
    case_plan of_case = {0};
    int points;
    log_set_quiet(options->quiet);
    interrupt_install();
    if (!static_check(&options->request, &points, error)) {
        return error->code;
    }
    CLEANUP_FREE static_analysis *a = xcalloc(1, sizeof *a);
    CLEANUP_FREE char *path = result_path("result", options->output, file, "-static.h5", error);
    a->of_case = &of_case;
    a->path = path;
    if (path != NULL && cached_case(&of_case, file, &options->set, PLAN_ROOT_STRESS, error)) {
        analyse_case(a, options, points, error);
    }
    static_analysis_free(a);
    case_plan_free(&of_case);
    return error->code;
}

static const option_row rows[] = {
    {OPTION_TEXT, 0, "--mesh", "NAME", offsetof(static_options, request.mesh),
     "mesh to analyse, by name or index; if not given, the first mesh"},
    {OPTION_TEXT, 0, "--torque", "FROM:TO:STEPS", offsetof(static_options, request.torque),
     "torques on the driving wheel, or a single torque, in N m or with units; negative: on the coast flanks; if not "
     "given, the torque of the loads"},
    {OPTION_TEXT, 0, "--speed", "SPEED", offsetof(static_options, request.speed),
     "speed of the driving wheel for the sliding friction of the mesh, in rad/s or with a unit such as '1500 rpm'; if "
     "not given, no friction"},
    {OPTION_TEXT, 0, "--points", "N", offsetof(static_options, request.points),
     "mesh positions per pitch; 200 if not given"},
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
    .summary = "compute transmission error, stiffness and load sharing of a mesh (quasi-static)",
    .text =
        "Computes the quasi-static state of one mesh under a torque on its driving wheel, at positions over a\n"
        "pitch. The results are transmission error, mesh stiffness, and forces and contact pressures of the tooth\n"
        "pairs. With pitch errors or runout, the positions cover all combinations of teeth. Axles are at their\n"
        "reference positions. Negative torques load the coast flanks. With --speed the friction law of the mesh is\n"
        "applied at this speed. It is positive in the sense of driving_rotation. The command writes an HDF5 file\n"
        "that netCDF-4 programs can read, and prints a summary.\n"
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
