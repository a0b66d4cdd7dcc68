#include "motion/motion_parts.h"

bool motion_fail(motion *m, const char *reason)
{
    CLEANUP_FREE char *location = xasprintf("%s: t = %.9g s", m->name, m->now.t);
    return evl_error_set(&m->error, EVL_EXIT_INTEGRATION, location, "%s", reason);
}

bool motion_fail_speed(motion *m, const motion_input *input, double turns)
{
    CLEANUP_FREE char *text =
        xasprintf("the speed given for wheel '%s' jumps: it is %.9g rad/s, and the wheel turns at %.9g "
                  "rad/s; a speed must agree with the acceleration given with it",
                  m->plan.description->wheels[input->of.wheel], input->value, turns);
    return motion_fail(m, text);
}

void motion_stop_stepper(motion *m)
{
    if (m->stepper != NULL) {
        m->dae->stepper->destroy(m->stepper);
        m->stepper = NULL;
    }
}

bool motion_make_stepper(motion *m)
{
    const integrate_options *options = &m->plan.integration;
    motion_stop_stepper(m);
    m->stepper = m->dae->stepper->create(m->dae->self, options->tolerance, options->max_step, m->message);
    return m->stepper != NULL || motion_fail(m, m->message);
}
