/* Co-simulation. */
#include "fmu/fmi3_instance.h"

#include <math.h>

typedef struct {
    double now, step;
    double reached;
} stride;

static void go(instance *self, void *with)
{
    static const double same = 1e-9; /* relative to the step: smaller differences of times are rounding */
    stride *s = with;
    const double t = motion_state(self->motion)->t;
    if (!(s->step > 0) || !isfinite(s->step)) {
        instance_refuse(self, fmi3Error, "the communication step is %.9g s, but must be positive", s->step);
    } else if (!(fabs(s->now - t) <= same * fmax(s->step, fabs(t)))) {
        instance_refuse(self, fmi3Error, "the communication point is %.9g s, but the FMU is at %.9g s", s->now, t);
    } else if (s->now + s->step - self->t_end > same * fmax(s->step, self->t_end)) {
        instance_refuse(self, fmi3Error, "the step ends at %.9g s, after the stop time %.9g s", s->now + s->step,
                        self->t_end);
    } else if (!motion_to(self->motion, s->now + s->step)) {
        instance_fail(self, DAE_FATAL);
    }
    s->reached = motion_state(self->motion)->t;
}

fmi3Status fmi3DoStep(fmi3Instance handle, fmi3Float64 now, fmi3Float64 step, fmi3Boolean no_set_state,
                      fmi3Boolean *event, fmi3Boolean *terminate, fmi3Boolean *early, fmi3Float64 *reached)
{
    stride s = {now, step, now};
    (void)no_set_state;
    const fmi3Status status = instance_call(handle, "fmi3DoStep", IN_STEP, go, &s);
    *event = *terminate = *early = false;
    *reached = s.reached;
    return status;
}

static void refuse(instance *self, void *with)
{
    (void)with;
    instance_refuse(self, fmi3Error, "in co-simulation this FMU has no event mode");
}

fmi3Status fmi3EnterStepMode(fmi3Instance handle)
{
    return instance_call(handle, "fmi3EnterStepMode", IN_ANY, refuse, NULL);
}
