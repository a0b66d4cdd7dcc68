/* Model exchange. */
#include "fmu/fmi3_instance.h"

#include <math.h>
#include <string.h>

/** Numbers passed to or from the importer. */
typedef struct {
    size_t n;
    double *to;
    const double *from;
} numbers;

static void enter_events(instance *self, void *with)
{
    (void)with;
    if (self->by_steps) {
        instance_refuse(self, fmi3Error, "in co-simulation this FMU has no event mode");
    } else {
        self->mode = IN_EVENT;
    }
}

fmi3Status fmi3EnterEventMode(fmi3Instance handle)
{
    return instance_call(handle, "fmi3EnterEventMode", IN_CONTINUOUS | IN_STEP, enter_events, NULL);
}

static void update(instance *self, void *with)
{
    if (!motion_update(self->motion, with)) {
        instance_fail(self, DAE_FATAL);
    }
}

fmi3Status fmi3UpdateDiscreteStates(fmi3Instance handle, fmi3Boolean *again, fmi3Boolean *terminate,
                                    fmi3Boolean *nominals_changed, fmi3Boolean *states_changed, fmi3Boolean *has_next,
                                    fmi3Float64 *next)
{
    static const double never = 1e300; /* the kernel returns the largest double in this case */
    motion_change change = {.next = INFINITY};
    const fmi3Status status = instance_call(handle, "fmi3UpdateDiscreteStates", IN_EVENT, update, &change);
    *again = change.again;
    *terminate = *nominals_changed = false;
    *states_changed = change.states_changed;
    *has_next = change.next < never;
    *next = *has_next ? change.next : 0;
    return status;
}

static void evaluate(instance *self, void *with)
{
    (void)self, (void)with; /* discrete states change in fmi3UpdateDiscreteStates only */
}

fmi3Status fmi3EvaluateDiscreteStates(fmi3Instance handle)
{
    return instance_call(handle, "fmi3EvaluateDiscreteStates", IN_INITIALIZATION | IN_EVENT, evaluate, NULL);
}

static void go_on(instance *self, void *with)
{
    (void)with;
    self->mode = IN_CONTINUOUS;
}

fmi3Status fmi3EnterContinuousTimeMode(fmi3Instance handle)
{
    return instance_call(handle, "fmi3EnterContinuousTimeMode", IN_EVENT, go_on, NULL);
}

static void complete(instance *self, void *with)
{
    if (!motion_check_speeds(self->motion)) {
        instance_fail(self, DAE_FATAL);
        return;
    }
    *(bool *)with = motion_is_due(self->motion);
}

fmi3Status fmi3CompletedIntegratorStep(fmi3Instance handle, fmi3Boolean no_set_state, fmi3Boolean *enter_event_mode,
                                       fmi3Boolean *terminate)
{
    bool is_due = false;
    (void)no_set_state;
    const fmi3Status status = instance_call(handle, "fmi3CompletedIntegratorStep", IN_CONTINUOUS, complete, &is_due);
    *enter_event_mode = is_due;
    *terminate = false;
    return status;
}

static void set_time(instance *self, void *with)
{
    if (instance_are_finite(self, 1, with)) {
        motion_set_state(self->motion, *(const double *)with, NULL);
    }
}

fmi3Status fmi3SetTime(fmi3Instance handle, fmi3Float64 time)
{
    return instance_call(handle, "fmi3SetTime", IN_CONTINUOUS | IN_EVENT, set_time, &time);
}

/** Whether the requested number of values is correct. */
static bool fits(instance *self, size_t n, int there)
{
    if (n != (size_t)there) {
        instance_refuse(self, fmi3Error, "%zu values are requested, but there are %d", n, there);
    }
    return n == (size_t)there;
}

static void set_states(instance *self, void *with)
{
    const numbers *x = with;
    if (fits(self, x->n, motion_about(self->motion)->n_states) && instance_are_finite(self, x->n, x->from)) {
        motion_set_state(self->motion, motion_state(self->motion)->t, x->from);
    }
}

fmi3Status fmi3SetContinuousStates(fmi3Instance handle, const fmi3Float64 states[], size_t n)
{
    return instance_call(handle, "fmi3SetContinuousStates", IN_CONTINUOUS | IN_EVENT, set_states,
                         &(numbers){n, NULL, states});
}

/** Pass on numbers, or report why there are none. */
static void give(instance *self, const numbers *x, int there, const double *from, dae_code code)
{
    if (from == NULL) {
        instance_fail(self, code);
    } else if (fits(self, x->n, there)) {
        memcpy(x->to, from, x->n * sizeof *from);
    }
}

static void get_rates(instance *self, void *with)
{
    dae_code code = DAE_OK;
    if (self->mode != IN_INITIALIZATION || instance_begin(self)) {
        give(self, with, motion_about(self->motion)->n_states, motion_rates(self->motion, &code), code);
    }
}

fmi3Status fmi3GetContinuousStateDerivatives(fmi3Instance handle, fmi3Float64 rates[], size_t n)
{
    return instance_call(handle, "fmi3GetContinuousStateDerivatives", IN_MOTION | IN_INITIALIZATION, get_rates,
                         &(numbers){n, rates, NULL});
}

static void get_indicators(instance *self, void *with)
{
    dae_code code = DAE_OK;
    if (self->mode != IN_INITIALIZATION || instance_begin(self)) {
        give(self, with, motion_about(self->motion)->n_indicators, motion_indicators(self->motion, &code), code);
    }
}

fmi3Status fmi3GetEventIndicators(fmi3Instance handle, fmi3Float64 indicators[], size_t n)
{
    return instance_call(handle, "fmi3GetEventIndicators", IN_MOTION | IN_INITIALIZATION, get_indicators,
                         &(numbers){n, indicators, NULL});
}

static void get_states(instance *self, void *with)
{
    if (self->mode != IN_INITIALIZATION || instance_begin(self)) {
        give(self, with, motion_about(self->motion)->n_states, motion_state(self->motion)->y, DAE_OK);
    }
}

fmi3Status fmi3GetContinuousStates(fmi3Instance handle, fmi3Float64 states[], size_t n)
{
    return instance_call(handle, "fmi3GetContinuousStates", IN_MOTION | IN_INITIALIZATION, get_states,
                         &(numbers){n, states, NULL});
}

static void get_nominals(instance *self, void *with)
{
    give(self, with, motion_about(self->motion)->n_states, motion_scales(self->motion), DAE_OK);
}

fmi3Status fmi3GetNominalsOfContinuousStates(fmi3Instance handle, fmi3Float64 nominals[], size_t n)
{
    return instance_call(handle, "fmi3GetNominalsOfContinuousStates", IN_MOTION | IN_INITIALIZATION, get_nominals,
                         &(numbers){n, nominals, NULL});
}

static void count_indicators(instance *self, void *with)
{
    *(size_t *)with = (size_t)motion_about(self->motion)->n_indicators;
}

fmi3Status fmi3GetNumberOfEventIndicators(fmi3Instance handle, size_t *n)
{
    return instance_call(handle, "fmi3GetNumberOfEventIndicators", IN_ANY, count_indicators, n);
}

static void count_states(instance *self, void *with)
{
    *(size_t *)with = (size_t)motion_about(self->motion)->n_states;
}

fmi3Status fmi3GetNumberOfContinuousStates(fmi3Instance handle, size_t *n)
{
    return instance_call(handle, "fmi3GetNumberOfContinuousStates", IN_ANY, count_states, n);
}
