#include "analyses/modes_find.h"

#include "base/memory.h"
#include "base/progress.h"
#include "case/unit.h"
#include "integrate/integrate.h"
#include "model/model_start.h"
#include "simulate/case_start.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- the motion up to a time ---- */

typedef struct {
    progress progress;
    const volatile sig_atomic_t *interrupt;
} motion;

static int on_step(void *self, double t)
{
    motion *motion = self;
    progress_step(&motion->progress, t);
    return *motion->interrupt != 0;
}

static bool move_to(const case_plan *plan, const modes_request *request, double time, dae_state *state,
                    evl_error *error)
{
    const integrate_options options = integrate_options_between(&plan->integration, state->t, time);
    motion motion = {.interrupt = request->interrupt};
    const integrate_observer observer = {.self = &motion, .step = on_step};
    integrate_counts counts;
    char reason[DAE_MESSAGE_LENGTH];
    progress_start(&motion.progress, request->is_shown, state->t, time);
    const integrate_code code = integrate(&model_about(plan->model)->dae, &options, &observer, state, &counts, reason);
    progress_end(&motion.progress);
    if (code == INTEGRATE_DONE) {
        return true;
    }
    CLEANUP_FREE char *location = xasprintf("%s: t = %.9g s", plan->path, state->t);
    return code == INTEGRATE_STOPPED ? evl_error_set(error, EVL_EXIT_INTERRUPTED, location, "interrupted by %s",
                                                     request->who(*request->interrupt))
                                     : evl_error_set(error, EVL_EXIT_INTEGRATION, location, "%s", reason);
}

/* ---- the state ---- */

/** Read the number of an option; unchanged if the option was not given. */
static bool read_number(const char *option, const char *text, const char *unit, double most, const char *range,
                        double *number, evl_error *error)
{
    if (text == NULL) {
        return true;
    }
    CLEANUP_FREE char *why = quantity_complaint(text, unit, range, number);
    if (why == NULL && *number >= 0.0 && *number <= most) {
        return true;
    }
    CLEANUP_FREE char *location = xasprintf("--%s %s", option, text);
    return evl_error_set(error, EVL_EXIT_USAGE, location, "%s", why == NULL ? range : why);
}

/** @return false */
static bool refuse_steady_state(const case_plan *plan, const model_message *refusal, evl_error *error)
{
    if (strncmp(refusal->field, MODEL_START, strlen(MODEL_START)) != 0) {
        return case_plan_refuse(plan, refusal, error);
    }
    return evl_error_set(/* the case does not require this state: do not blame a line of the case */
                         error, EVL_EXIT_CASE, plan->path,
                         "there is no steady state to linearise at: %s; --at TIME linearises the motion at a time "
                         "instead",
                         refusal->message);
}

static bool find_state_at(const modes_request *request, double time, modes_report *report, evl_error *error)
{
    const case_plan *plan = report->plan;
    dae_state *state = &report->state;
    const double duration = plan->integration.t_end;
    if (time > duration) {
        CLEANUP_FREE char *location = xasprintf("--at %s", request->at);
        return evl_error_set(error, EVL_EXIT_CASE, location,
                             "the case ends at %.9g s; --set simulation.duration=%.9g makes it longer", duration, time);
    }
    return case_start(plan, request->interrupt, state, &report->start, error) &&
           (time <= state->t || move_to(plan, request, time, state, error));
}

/** Find the modes at one state. */
static bool linearise(modes_report *report, evl_error *error)
{
    const case_plan *plan = report->plan;
    const dae_state *state = &report->state;
    char message[DAE_MESSAGE_LENGTH];
    return (model_outputs(plan->model, state, report->values, message) == DAE_OK &&
            model_modes(plan->model, state, &report->modes, message)) ||
           evl_error_set(error, EVL_EXIT_CASE, plan->path, "cannot be linearised at t = %.9g s: %s", state->t, message);
}

bool modes_read(const modes_request *request, modes_point *point, evl_error *error)
{
    static const double most_pitches = 1e6;
    *point = (modes_point){0.0, NAN};
    return read_number("at", request->at, "s", HUGE_VAL, "the time must be a number of seconds, at least 0",
                       &point->time, error) &&
           read_number("mesh-position", request->mesh_position, NULL, most_pitches,
                       "the position must be a number of pitches, from 0 to 1e6", &point->position, error);
}

const char *modes_check(const modes_request *request)
{
    const int n_states = (request->at != NULL) + (request->mesh_position != NULL) + request->mean;
    return n_states > 1 ? "one of '--at', '--mesh-position' and '--mean' at a time" : NULL;
}

/** Find the modes at the mean of the steady states, or at one state. */
static bool find(const modes_request *request, const modes_point *point, modes_report *report, evl_error *error)
{
    const case_plan *plan = report->plan;
    dae_state *state = &report->state;
    model_message refusal;
    if (request->mean) {
        return model_mean_modes(plan->model, 0, state, report->values, &report->modes, &refusal) ||
               refuse_steady_state(plan, &refusal, error);
    }
    return (request->at != NULL ? find_state_at(request, point->time, report, error)
                                : model_state_under_load(plan->model, point->position, state, &refusal) ||
                                      refuse_steady_state(plan, &refusal, error)) &&
           linearise(report, error);
}

bool modes_find(const case_plan *plan, const modes_request *request, const modes_point *point, modes_report *report,
                evl_error *error)
{
    *report = (modes_report){.plan = plan,
                             .values = xcalloc((size_t)model_about(plan->model)->n_values, sizeof(double)),
                             .kind = request->mean         ? MODES_MEAN
                                     : request->at != NULL ? MODES_AT
                                                           : MODES_STEADY,
                             .mesh_position = point->position};
    /* a case that cannot run has no modes either */
    return (request->at != NULL || case_start_check(plan, error)) && find(request, point, report, error);
}

void modes_free(modes_report *report)
{
    free(report->values);
    arena_free(&report->modes.arena);
    dae_state_free(&report->state);
}
