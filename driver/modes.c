#include "modes.h"

#include "integrate.h"
#include "interrupt.h"
#include "memory.h"
#include "modes_print.h"
#include "number.h"
#include "prepare.h"
#include "progress.h"

#include <stdlib.h>

/* ---- the motion up to a time ---- */

static int on_output(void *self, const dae_state *state)
{
    (void)self, (void)state;
    return 0;
}

static int on_event(void *self, const event_record *record)
{
    (void)self, (void)record;
    return 0;
}

static int on_step(void *self, double t)
{
    progress_step(self, t);
    return interrupt_signal != 0;
}

static bool move_to(const prepared_case *prepared, double time, dae_state *state, evl_error *error)
{
    const simulation_description *simulation = &case_description(prepared->file)->simulation;
    const integrate_options options = {.t_end = time,
                                       .output_interval = time,
                                       .tolerance = simulation->tolerance,
                                       .max_step = simulation->max_step,
                                       .by_stepper = simulation->integrator == INTEGRATOR_RADAU};
    progress progress;
    const integrate_observer observer = {.self = &progress, .output = on_output, .event = on_event, .step = on_step};
    integrate_counts counts;
    char reason[DAE_MESSAGE_LENGTH];
    progress_start(&progress, true, state->t, time);
    const integrate_code code = integrate(model_dae(prepared->model), &options, &observer, state, &counts, reason);
    progress_end(&progress);
    if (code == INTEGRATE_DONE) {
        return true;
    }
    char *place = xasprintf("%s: t = %.9g s", case_path(prepared->file), state->t);
    if (code == INTEGRATE_STOPPED) {
        evl_error_set(error, EVL_EXIT_INTERRUPTED, place, "interrupted by %s", interrupt_name((int)interrupt_signal));
    } else {
        evl_error_set(error, EVL_EXIT_INTEGRATION, place, "%s", reason);
    }
    free(place);
    return false;
}

/* ---- the state ---- */

static bool read_time(const char *text, double *time, evl_error *error)
{
    if (number_read(text, time) == NUMBER_FINITE && *time >= 0.0) {
        return true;
    }
    char *place = xasprintf("--at %s", text);
    evl_error_set(error, EVL_EXIT_USAGE, place, "the time must be a number of seconds, at least 0");
    free(place);
    return false;
}

static bool find_steady_state(const prepared_case *prepared, dae_state *state, evl_error *error)
{
    model_message refusal;
    if (!prepare_start(prepared, state, error)) { /* what cannot run has no modes either */
        return false;
    }
    dae_state_free(state);
    if (model_steady_state(prepared->model, state, &refusal)) {
        return true;
    }
    if (refusal.subject ==
        MODEL_ABOUT_INITIAL) { /* the case need not ask for a steady start: its lines are not to blame */
        evl_error_set(error, EVL_EXIT_CASE, case_path(prepared->file),
                      "there is no steady state to linearise at: %s; --at TIME linearises the motion at a time instead",
                      refusal.message);
    } else {
        prepare_refuse(prepared, &refusal, error);
    }
    return false;
}

static bool find_state_at(const prepared_case *prepared, const char *at, double time, dae_state *state,
                          evl_error *error)
{
    const double duration = case_description(prepared->file)->simulation.duration;
    if (time > duration) {
        char *place = xasprintf("--at %s", at);
        evl_error_set(error, EVL_EXIT_CASE, place,
                      "the case ends at %.9g s; --set simulation.duration=%s makes it longer", duration, at);
        free(place);
        return false;
    }
    if (!prepare_start(prepared, state, error)) {
        return false;
    }
    if (time > state->t && !move_to(prepared, time, state, error)) {
        dae_state_free(state);
        return false;
    }
    return true;
}

/* ---- the command ---- */

static evl_exit print_modes(const prepared_case *prepared, const dae_state *state, const modes_options *options,
                            FILE *stream, evl_error *error)
{
    char message[DAE_MESSAGE_LENGTH];
    const model *model = prepared->model;
    modes_report report = {.file = prepared->file, .model = model, .state = state, .is_steady = options->at == NULL};
    double *values = xcalloc((size_t)model_n_values(model), sizeof *values);
    report.values = values;
    evl_exit code = EVL_EXIT_CASE;
    if (model_outputs(model, state, values, message) == DAE_OK && model_modes(model, state, &report.modes, message)) {
        code = (evl_exit)(options->json ? modes_print_json(stream, &report) : modes_print_text(stream, &report));
        natural_modes_free(&report.modes);
    } else {
        evl_error_set(error, code, case_path(prepared->file), "cannot be linearised at t = %.9g s: %s", state->t,
                      message);
    }
    free(values);
    return code;
}

evl_exit modes_case(const modes_options *options, FILE *stream, evl_error *error)
{
    prepared_case prepared;
    dae_state state;
    double time = 0.0;
    *error = (evl_error){.code = EVL_EXIT_OK};
    if ((options->at != NULL && !read_time(options->at, &time, error)) ||
        !prepare_case(&prepared, options->case_path, options->n_set, options->set, error)) {
        return error->code;
    }
    evl_exit code = EVL_EXIT_OK;
    if (options->at == NULL ? find_steady_state(&prepared, &state, error)
                            : find_state_at(&prepared, options->at, time, &state, error)) {
        prepare_warn(&prepared);
        code = print_modes(&prepared, &state, options, stream, error);
        dae_state_free(&state);
    } else {
        code = error->code;
    }
    prepared_case_free(&prepared);
    return code;
}
