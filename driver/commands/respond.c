#include "respond/respond.h"

#include "base/interrupt.h"
#include "base/log.h"
#include "base/memory.h"
#include "commands/command.h"
#include "commands/result.h"
#include "respond/respond_orbits.h"

#include <string.h>

typedef struct {
    const char *over;    /**< PATH=FROM:TO[:STEPS] */
    const char *output;  /**< NULL: the case's name with -respond.h5 in the current folder */
    const char *most;    /**< common periods at a value */
    const char *method;  /**< "sweep" or "orbits" */
    const char *values;  /**< number of values in the range with orbits */
    const char *longest; /**< longest orbit in common periods */
    option_values set;
    bool up, down, both, quiet;
} options_t;

static bool finds_orbits(const options_t *options)
{
    return options->method != NULL && strcmp(options->method, "orbits") == 0;
}

static const char *check(const void *given)
{
    const options_t *options = given;
    int count = 0;
    if (options->over == NULL) {
        return "--over PATH=FROM:TO[:STEPS] gives the parameter and its range";
    }
    if (options->up + options->down + options->both > 1) {
        return "--up, --down and --both exclude each other";
    }
    if (options->method != NULL && strcmp(options->method, "sweep") != 0 && strcmp(options->method, "orbits") != 0) {
        return "--method takes sweep or orbits";
    }
    if (finds_orbits(options) && options->up + options->down + options->both > 0) {
        return "--method orbits follows branches in both directions; omit --up, --down and --both";
    }
    if (!finds_orbits(options) && (options->values != NULL || options->longest != NULL)) {
        return "--values and --longest require --method orbits";
    }
    if (options->values != NULL && !respond_read_values(options->values, &count)) {
        return respond_values;
    }
    if (options->longest != NULL && !respond_read_longest(options->longest, &count)) {
        return respond_longest;
    }
    return options->most == NULL || respond_read_most(options->most, &count) ? NULL : respond_periods;
}

static evl_exit run_respond(const char *file, const void *given, evl_error *error)
{
    const options_t *options = given;
    int most = 0, n_values = 0, longest = 0;
    log_set_quiet(options->quiet);
    interrupt_install();
    if (strcmp(file, "-") == 0) {
        evl_error_set(error, EVL_EXIT_USAGE, "",
                      "respond reads the case again for every value; give a file, not standard input");
        return error->code;
    }
    CLEANUP_FREE char *path = result_path("response", options->output, file, "-respond.h5", error),
                      *versions = result_versions();
    (void)(options->most != NULL && respond_read_most(options->most, &most));
    (void)(options->longest != NULL && respond_read_longest(options->longest, &longest));
    (void)(options->values != NULL && respond_read_values(options->values, &n_values));
    if (path == NULL) {
        return error->code;
    }
    const respond_options asked = {.over = options->over,
                                   .up = !options->down,
                                   .down = !options->up,
                                   .orbits = finds_orbits(options) ? respond_orbits : NULL,
                                   .n_values = n_values,
                                   .longest = longest,
                                   .most = most,
                                   .path = path,
                                   .versions = versions,
                                   .n_set = options->set.n,
                                   .set = options->set.values,
                                   .quiet = options->quiet};
    return respond(file, &asked, error);
}

static const option_row rows[] = {
    {OPTION_TEXT, 0, "--over", "PATH=FROM:TO[:STEPS]", offsetof(options_t, over),
     "parameter; its first and last value, with or without units; number of values, 101 if not given"},
    {OPTION_FLAG, 0, "--up", NULL, offsetof(options_t, up), "only from FROM to TO"},
    {OPTION_FLAG, 0, "--down", NULL, offsetof(options_t, down), "only from TO to FROM"},
    {OPTION_FLAG, 0, "--both", NULL, offsetof(options_t, both), "up, then down; the default"},
    {OPTION_TEXT, 0, "--periods", "N", offsetof(options_t, most),
     "largest number of common periods at a value; if not given, 25 time constants of the slowest mode, at least 600 "
     "pitches"},
    {OPTION_TEXT, 0, "--method", "NAME", offsetof(options_t, method),
     "sweep: simulate from value to value, the default; orbits: continue stable and unstable periodic orbits"},
    {OPTION_TEXT, 0, "--values", "N", offsetof(options_t, values),
     "with orbits: also find stable orbits at N evenly spaced values from FROM to TO, as a sweep with N STEPS does"},
    {OPTION_TEXT, 0, "--longest", "N", offsetof(options_t, longest),
     "with orbits: largest period of an orbit, in common periods; 16 if not given"},
    {OPTION_TEXT, 'o', "--output", "FILE.h5", offsetof(options_t, output),
     "file to write; the case's name with -respond.h5 in the current folder if not given"},
    OPTION_ROW_SET(options_t),
    OPTION_ROW_QUIET(options_t),
    OPTION_ROW_HELP,
};

const command respond_command = {
    .name = "respond",
    .synopsis = "CASE.yaml --over PATH=FROM:TO[:STEPS] [--up | --down | --both] [--periods N] [--method "
                "sweep|orbits] [--values N] [--longest N] [-o FILE.h5] [--set "
                "PATH=VALUE]... [-q]",
    .summary = "compute the nonlinear response, with jumps, over an increasing and decreasing parameter",
    .text =
        "Simulates the case at each value of a parameter, starting from the final state at the previous value. The\n"
        "motion is simulated until it repeats after 1 to 16 common periods of all meshes and loads, or for at most\n"
        "--periods common periods. The result file contains, for each value, up and down: the period, the metrics\n"
        "over whole periods, and the jumps of the motion. The same command continues a stopped response.\n"
        "\n"
        "--method orbits computes periodic orbits from these motions and continues them through folds and period\n"
        "doublings. Stable and unstable orbits are included, with their Floquet multipliers. STEPS, 2 if not\n"
        "given, is then the number of values at which motions are simulated to find the first orbits.\n"
        "\n"
        "Examples:\n"
        "  evolvent respond examples/spur-pair.yaml --over meshes.pinion-gear.damping.value=0.05:0.1:3\n"
        "  evolvent respond examples/spur-pair.yaml --over 'wheels.pinion.loads.0.value=-500 rpm:-1000 rpm:3' --set "
        "'wheels.pinion.loads.0={kind: speed, value: -157}' --set 'wheels.gear.loads.0={kind: torque, value: -90}' "
        "--up -o speeds.h5\n",
    .file = "case file",
    .size = sizeof(options_t),
    OPTION_ROWS(rows),
    .check = check,
    .run = run_respond,
};
