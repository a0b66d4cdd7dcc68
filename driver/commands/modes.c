#include "base/interrupt.h"
#include "base/memory.h"
#include "base/progress.h"
#include "case/unit.h"
#include "commands/command.h"
#include "commands/modes_print.h"
#include "commands/warn.h"
#include "integrate/integrate.h"
#include "simulate/simulate.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct {
    /* Which state: at most one of these three; none: the steady state where the case starts. */
    const char *at;            /**< time [s] as a text, or NULL */
    const char *mesh_position; /**< steady state at so many pitches from the start of contact, as a text, or NULL */
    bool mean;                 /**< the mean over the steady states at all positions of the meshes */
    option_values set;
    bool json; /**< one JSON object, else text for reading */
} modes_options;

/* ---- the motion up to a time ---- */

static int on_step(void *self, double t)
{
    progress_step(self, t);
    return interrupt_signal != 0;
}

static bool move_to(const prepared_case *prepared, double time, dae_state *state, evl_error *error)
{
    integrate_options options = simulate_options(prepared);
    options.t_end = options.output_interval = time;
    options.per_unit = 0;
    progress progress;
    const integrate_observer observer = {.self = &progress, .step = on_step};
    integrate_counts counts;
    char reason[DAE_MESSAGE_LENGTH];
    progress_start(&progress, true, state->t, time);
    const integrate_code code =
        integrate(&model_about(prepared->model)->dae, &options, &observer, state, &counts, reason);
    progress_end(&progress);
    if (code == INTEGRATE_DONE) {
        return true;
    }
    OWNED char *place = xasprintf("%s: t = %.9g s", case_path(prepared->file), state->t);
    return code == INTEGRATE_STOPPED ? evl_error_set(error, EVL_EXIT_INTERRUPTED, place, "interrupted by %s",
                                                     interrupt_name((int)interrupt_signal))
                                     : evl_error_set(error, EVL_EXIT_INTEGRATION, place, "%s", reason);
}

/* ---- the state ---- */

/** The number of an option; none if the option was not given. */
static bool read_number(const char *option, const char *text, const char *unit, double most, const char *range,
                        double *number, evl_error *error)
{
    if (text == NULL) {
        return true;
    }
    OWNED char *why = quantity_complaint(text, unit, range, number);
    if (why == NULL && *number >= 0.0 && *number <= most) {
        return true;
    }
    OWNED char *place = xasprintf("--%s %s", option, text);
    return evl_error_set(error, EVL_EXIT_USAGE, place, "%s", why == NULL ? range : why);
}

/** @return false */
static bool refuse_steady_state(const prepared_case *prepared, const model_message *refusal, evl_error *error)
{
    if (strncmp(refusal->field, MODEL_START, strlen(MODEL_START)) != 0) {
        return prepare_refuse(prepared, refusal, error);
    }
    return evl_error_set(/* the case need not ask for it: its lines are not to blame */
                         error, EVL_EXIT_CASE, case_path(prepared->file),
                         "there is no steady state to linearise at: %s; --at TIME linearises the motion at a time "
                         "instead",
                         refusal->message);
}

static bool find_state_at(const prepared_case *prepared, const char *at, double time, dae_state *state,
                          evl_error *error)
{
    const double duration = case_description(prepared->file)->simulation.duration;
    if (time > duration) {
        OWNED char *place = xasprintf("--at %s", at);
        return evl_error_set(error, EVL_EXIT_CASE, place,
                             "the case ends at %.9g s; --set simulation.duration=%.9g makes it longer", duration, time);
    }
    return prepare_start(prepared, state, error) && (time <= state->t || move_to(prepared, time, state, error));
}

/* ---- the command ---- */

/** The modes at one state. */
static bool linearise(const prepared_case *prepared, const dae_state *state, double *values, natural_modes *modes,
                      evl_error *error)
{
    char message[DAE_MESSAGE_LENGTH];
    return (model_outputs(prepared->model, state, values, message) == DAE_OK &&
            model_modes(prepared->model, state, modes, message)) ||
           evl_error_set(error, EVL_EXIT_CASE, case_path(prepared->file), "cannot be linearised at t = %.9g s: %s",
                         state->t, message);
}

static void modes_of(const prepared_case *prepared, const modes_options *options, double time, double position,
                     evl_error *error)
{
    dae_state state = {.t = 0.0};
    model_message refusal;
    OWNED double *values = xcalloc((size_t)model_about(prepared->model)->n_values, sizeof *values);
    modes_report report = {.file = prepared->file,
                           .model = prepared->model,
                           .state = &state,
                           .values = values,
                           .kind = options->mean         ? MODES_MEAN
                                   : options->at != NULL ? MODES_AT
                                                         : MODES_STEADY,
                           .mesh_position = position};
    /* what cannot run has no modes either */
    bool good = options->at != NULL || prepare_check_start(prepared, error);
    if (good && options->mean) {
        good = model_mean_modes(prepared->model, &state, values, &report.modes, &refusal) ||
               refuse_steady_state(prepared, &refusal, error);
    } else if (good) {
        good = (options->at != NULL ? find_state_at(prepared, options->at, time, &state, error)
                                    : model_steady_state(prepared->model, position, &state, &refusal) ||
                                          refuse_steady_state(prepared, &refusal, error)) &&
               linearise(prepared, &state, values, &report.modes, error);
    }
    if (good) {
        warn_of_case(prepared);
    }
    if (good && options->json) {
        modes_print_json(stdout, &report);
    } else if (good) {
        modes_print_text(stdout, &report);
    }
    pool_free(&report.modes.pool);
    dae_state_free(&state);
}

static evl_exit modes(const char *file, const void *given, evl_error *error)
{
    static const double most_pitches = 1e6;
    const modes_options *options = given;
    prepared_case prepared = {0};
    double time = 0.0, position = 0.0;
    interrupt_install();
    if (read_number("at", options->at, "s", HUGE_VAL, "the time must be a number of seconds, at least 0", &time,
                    error) &&
        read_number("mesh-position", options->mesh_position, NULL, most_pitches,
                    "the position must be a number of pitches, from 0 to 1e6", &position, error) &&
        prepare_case(&prepared, file, options->set.n, options->set.values, error)) {
        modes_of(&prepared, options, time, position, error);
    }
    prepared_case_free(&prepared);
    return error->code;
}

static const char *check(const void *given)
{
    const modes_options *options = given;
    const int n_states = (options->at != NULL) + (options->mesh_position != NULL) + options->mean;
    return n_states > 1 ? "one of '--at', '--mesh-position' and '--mean' at a time" : NULL;
}

static const option_row rows[] = {
    {OPTION_TEXT, 0, "--at", "TIME", offsetof(modes_options, at),
     "integrate the case from its initial state to this time [s], or such as '20 ms', and linearise there"},
    {OPTION_TEXT, 0, "--mesh-position", "X", offsetof(modes_options, mesh_position),
     "linearise where a tooth pair of the first mesh is X pitches from the start of contact; 0 if not given"},
    {OPTION_FLAG, 0, "--mean", NULL, offsetof(modes_options, mean),
     "linearise at all positions of the meshes and take the mean"},
    OPTION_ROW_SET(modes_options),
    OPTION_ROW_JSON(modes_options),
    OPTION_ROW_HELP,
};

const command modes_command = {
    .name = "modes",
    .synopsis = "CASE.yaml [--at TIME | --mesh-position X | --mean] [--set PATH=VALUE]... [--json]",
    .summary = "print natural frequencies, damping and mode shapes",
    .text =
        "Linearises the gearbox and prints its natural frequencies, damping ratios and mode shapes: at its steady "
        "state "
        "under\n"
        "load, whatever the case's initial state, with a tooth pair of the first mesh at the start of contact, or X "
        "pitches\n"
        "from it; with the mean over all positions of the meshes; or, with --at, where the motion of the case is at a "
        "time.\n"
        "\n"
        "Examples:\n"
        "  evolvent modes examples/paper.yaml\n"
        "  evolvent modes examples/spur-pair.yaml --mesh-position 0.25\n"
        "  evolvent modes examples/spur-pair.yaml --mean\n"
        "  evolvent modes examples/paper-friction.yaml --at 0.5 --json\n",
    .file = "case file",
    .size = sizeof(modes_options),
    OPTION_ROWS(rows),
    .check = check,
    .run = modes,
};
