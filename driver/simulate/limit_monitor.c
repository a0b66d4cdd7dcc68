#include "simulate/limit_monitor.h"

#include "base/memory.h"

#include <stdio.h>
#include <stdlib.h>

void limit_monitor_init(limit_monitor *monitor, const model *model)
{
    *monitor = (limit_monitor){.model = model_has_friction_limits(model) ? model : NULL};
    monitor->y = monitor->model == NULL ? NULL : xcalloc((size_t)model_about(model)->dae.n, sizeof *monitor->y);
}

void limit_monitor_free(limit_monitor *monitor)
{
    free(monitor->y);
    monitor->y = NULL;
}

void limit_monitor_serialize(limit_monitor *monitor, archive *archive)
{
    SERIALIZE_ARRAY(archive, monitor->text, sizeof monitor->text);
    monitor->model = monitor->text[0] == '\0' ? monitor->model : NULL;
}

void limit_monitor_step(limit_monitor *monitor, const integrate_step *step)
{
    model_message found;
    if (monitor->model == NULL || !(step->t_to > step->t_from)) {
        return;
    }
    dae_state state = *step->state; /* of IDA its y is older */
    state.t = step->t_to;
    state.y = monitor->y;
    if (!step->interpolate(step->with, step->t_to, monitor->y) ||
        model_check_friction_limits(monitor->model, &state, &found)) {
        return;
    }
    monitor->model = NULL;
    (void)snprintf(monitor->text, sizeof monitor->text,
                   "%.100s: %.200s, first at t = %.4g s; checked at the ends of all steps up to this time", found.field,
                   found.message, step->t_to);
}
