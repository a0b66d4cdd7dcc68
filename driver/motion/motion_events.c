/* Motion with an external integrator: states, rates, indicators, events. */
#include "motion/motion.h"

#include "integrate/smallest_step.h"
#include "motion/motion_parts.h"

#include <math.h>
#include <string.h>

/** Distance before its zero at which an indicator counts as past it: half of the distance that the program keeps after
 *  an event, since rounding may stop an importer on either side. */
static const double eager = 0.5e-10;
/** Permitted relative error of a speed that a caller integrates from its rate. */
static const double agreement = 1e-3;

const dae_state *motion_state(const motion *m)
{
    return &m->now;
}

const double *motion_scales(const motion *m)
{
    return m->dae->scale;
}

void motion_set_state(motion *m, double t, const double *y)
{
    m->now.t = t;
    if (y != NULL) {
        memcpy(m->now.y, y, (size_t)m->dae->n * sizeof *y);
    }
    m->has_outputs = false;
}

static const double *checked_values(motion *m, dae_code found, const double *values, dae_code *code)
{
    *code = found;
    if (found != DAE_OK) {
        (void)motion_fail(m, m->message);
    }
    return found == DAE_OK ? values : NULL;
}

const double *motion_rates(motion *m, dae_code *code)
{
    return checked_values(m, (dae_code)model_rates(m->plan.model, &m->now, m->message), m->now.yp, code);
}

const double *motion_indicators(motion *m, dae_code *code)
{
    return checked_values(m, (dae_code)m->dae->roots(m->dae->self, &m->now, m->roots, m->message), m->roots, code);
}

const double *motion_outputs(motion *m, dae_code *code)
{
    *code = DAE_OK;
    if (!m->has_outputs) {
        *code = (dae_code)model_sampler_at(m->sampler, false, &m->now, m->values, m->message);
        m->has_outputs = *code == DAE_OK;
    }
    return checked_values(m, *code, m->values, code);
}

/** Find the indicators past zero. @return their number; -1 on failure */
static int find_fired(motion *m)
{
    dae_code code;
    int n = 0;
    if (motion_indicators(m, &code) == NULL) {
        return -1;
    }
    m->dae->root_directions(m->dae->self, m->now.integers, m->directions);
    for (int i = 0; i < m->dae->n_roots; i++) {
        const bool has_fired = m->directions[i] != 0 && m->directions[i] * m->roots[i] >= -eager;
        m->fired[i] = has_fired ? m->directions[i] : 0;
        n += has_fired;
    }
    return n;
}

static double next_time(const motion *m)
{
    return m->dae->next_time_event(m->dae->self, &m->now);
}

bool motion_is_due(motion *m)
{
    return find_fired(m) != 0 || !integration_is_later(next_time(m), m->now.t);
}

bool motion_apply(motion *m, dae_state *state, bool time_event)
{
    const dae *dae = m->dae;
    int n_events = 0;
    if (!progress_rate_event(&m->progress_rate, state->t,
                             progress_rate_resolution(state->t, m->plan.integration.t_end))) {
        return motion_fail(m, "endless events: the model chatters");
    }
    dae_state_copy(dae, &m->old, state);
    m->has_outputs = false;
    if (dae->apply_event(dae->self, state, m->fired, time_event, m->events, &n_events, m->message) != DAE_OK) {
        dae_state_copy(dae, state, &m->old);
        return motion_fail(m, m->message);
    }
    return true;
}

bool motion_update(motion *m, motion_change *change)
{
    const double t_event = next_time(m), t = m->now.t;
    const bool time_event = !integration_is_later(t_event, t);
    *change = (motion_change){.next = t_event};
    m->error = (evl_error){EVL_EXIT_OK, "", ""};
    const int n = find_fired(m);
    if (n < 0 || (n == 0 && !time_event)) {
        return n == 0;
    }
    m->now.t = time_event ? fmax(t, t_event) : t; /* due to rounding it may be just before */
    const bool good = motion_apply(m, &m->now, time_event);
    m->now.t = t;
    change->next = next_time(m);
    change->states_changed = memcmp(m->old.y, m->now.y, (size_t)m->dae->n * sizeof *m->now.y) != 0;
    change->again = good && motion_is_due(m);
    return good && m->error.code == EVL_EXIT_OK;
}

bool motion_check_speeds(motion *m)
{
    for (int i = 0; i < m->about.n_inputs; i++) {
        const motion_input *input = &m->about.inputs[i];
        const double turns = model_wheel_speed(m->plan.model, input->of.wheel, &m->now);
        if (input->of.is_speed && !(fabs(input->value - turns) <= agreement * fmax(fabs(input->value), fabs(turns)))) {
            return motion_fail_speed(m, input, turns);
        }
    }
    return true;
}
