#include "respond/shortcut.h"

#include "model/model_orbits.h"
#include "model/model_start.h"
#include "simulate/simulate.h"

#include <math.h>

/** All orbits belong to one model: the parameter is constant. */
static const model *take(void *self, double value, char message[DAE_MESSAGE_LENGTH])
{
    (void)value;
    (void)message;
    return self;
}

/** Integration to the next section. */
typedef struct {
    section section;
    dae_state at;
    bool is_there;
    const volatile sig_atomic_t *interrupt;
} passage;

static void on_monitor(void *self, const integrate_step *step)
{
    passage *p = self;
    p->is_there = p->is_there || (step->t_to > step->t_from && section_reached(&p->section, step, &p->at));
}

static int on_event(void *self, const event_record *record)
{
    (void)self;
    (void)record;
    return 0;
}

static int on_step(void *self, double t)
{
    const passage *p = self;
    (void)t;
    return p->is_there || *p->interrupt != 0;
}

/** Follow an orbit to the section of a motion: without a prescribed speed it was found near the section, not on it. */
static bool go_to_section(const section *section, const dae_state *state, double time, const integrate_options *usual,
                          const volatile sig_atomic_t *interrupt, state_transfer *to)
{
    ARENA_SCOPE memory_arena arena = {NULL};
    char message[DAE_MESSAGE_LENGTH];
    const dae *dae = &model_about(section->model)->dae;
    passage passage = {.at = dae_state_create(dae, &arena), .interrupt = interrupt};
    dae_state now = dae_state_create(dae, &arena);
    if (!model_take_over(section->model, dae, state, state->t, &now, message)) {
        return false;
    }
    section_begin(&passage.section, &arena, section->model, &section->period, section->phase, &now);
    const integrate_options options = integrate_options_between(usual, now.t, now.t + 2 * time);
    const integrate_observer observer = {.self = &passage, .event = on_event, .step = on_step, .monitor = on_monitor};
    integrate_counts counts;
    (void)integrate(dae, &options, &observer, &now, &counts, message);
    if (passage.is_there) {
        state_transfer_set(to, &passage.section, &passage.at);
    }
    return passage.is_there;
}

bool shortcut_quasi_static(const case_plan *plan, const model_period *period, double phase,
                           const volatile sig_atomic_t *interrupt, state_transfer *to)
{
    ARENA_SCOPE memory_arena arena = {NULL};
    model_message refusal;
    dae_state state;
    if (!model_steady_state(plan->model, &state, &refusal)) {
        return false;
    }
    section section;
    section_begin(&section, &arena, plan->model, period, phase, &state);
    const double rate = period->by_time ? period->pitches / period->time : section_pitch_rate(&section, &state);
    const bool good =
        rate > 0 && go_to_section(&section, &state, period->pitches / rate, &plan->integration, interrupt, to);
    dae_state_free(&state);
    return good;
}

bool shortcut_find(const section *section, const state_transfer *near, int periods, double time,
                   const integrate_options *options, const volatile sig_atomic_t *interrupt, state_transfer *to)
{
    static const double value = 0.5;
    char message[DAE_MESSAGE_LENGTH];
    const model_orbits_setup setup = {
        .self = (void *)section->model, .take = take, .from = 0, .to = 1, .position = near->pitches};
    model_orbits *orbits = model_orbits_create(&setup, value, message);
    if (orbits == NULL) {
        return false;
    }
    model_orbit orbit;
    dae_state state = dae_state_create(&model_about(section->model)->dae, NULL);
    const bool good = model_orbits_find(orbits, value, periods, periods * time, &near->state, &orbit, message) &&
                      orbit.is_stable && model_orbits_state(orbits, -1, 0, &state, message) &&
                      go_to_section(section, &state, time, options, interrupt, to);
    dae_state_free(&state);
    model_orbits_delete(&orbits);
    return good;
}
