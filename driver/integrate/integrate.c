#include "integrate/integrate.h"

#include "integrate/integration.h"

#include <float.h>

integrate_code integrate(const dae *model, const integrate_options *options, const integrate_observer *observer,
                         dae_state *state, integrate_counts *counts, char reason[DAE_MESSAGE_LENGTH])
{
    integration run = {.model = model,
                       .options = options,
                       .observer = observer,
                       .state = state,
                       .counts = counts,
                       .reason = reason,
                       .t_start = state->t,
                       .progress_rate = progress_rate_create(),
                       .t_unmonitored = state->t,
                       .t_missed = -DBL_MAX,
                       .cpu_start = integration_cpu_now(),
                       .t_rest = state->t};
    reason[0] = '\0';
    *counts = (integrate_counts){0};
    integration_begin(&run);
    if (observer->resume == NULL) {
        integration_monitor_state(&run);
    }
    const integrate_code code = options->by_stepper ? integrate_by_stepper(&run) : integrate_by_ida(&run);
    arena_free(&run.arena);
    counts->cpu_seconds = integration_cpu_now() - run.cpu_start;
    return code;
}
