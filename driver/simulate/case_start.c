#include "simulate/case_start.h"

#include "model/model_start.h"

/** Check that a state is allowed by the outputs of the case. @return false with the reason in `error`; then it is freed */
static bool accept(const case_plan *plan, dae_state *state, evl_error *error)
{
    model_message refusal;
    if (positions_check_start(&plan->positions, plan->model, state, &refusal)) {
        return true;
    }
    dae_state_free(state);
    return case_plan_refuse(plan, &refusal, error);
}

bool case_start(const case_plan *plan, const volatile sig_atomic_t *interrupt, dae_state *state,
                model_start_orbit *orbit, evl_error *error)
{
    static const evl_exit codes[] = {[MODEL_START_FOUND] = EVL_EXIT_OK,
                                     [MODEL_START_REFUSED] = EVL_EXIT_CASE,
                                     [MODEL_START_NOT_FOUND] = EVL_EXIT_INTEGRATION,
                                     [MODEL_START_INTERRUPTED] = EVL_EXIT_INTERRUPTED};
    model_message refusal;
    model_start_orbit found;
    const model_start_end end =
        model_initial_state(plan->model, interrupt, state, orbit != NULL ? orbit : &found, &refusal);
    if (end != MODEL_START_FOUND) {
        (void)case_plan_refuse(plan, &refusal, error);
        error->code = codes[end];
        return false;
    }
    return accept(plan, state, error);
}

bool case_start_check(const case_plan *plan, evl_error *error)
{
    dae_state state;
    model_message refusal;
    const bool good = model_check_start(plan->model, &state, &refusal) ? accept(plan, &state, error)
                                                                       : case_plan_refuse(plan, &refusal, error);
    if (good) {
        dae_state_free(&state);
    }
    return good;
}
