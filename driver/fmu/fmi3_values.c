/* Values of variables, all of them 64-bit floats. */
#include "fmu/fmi3_instance.h"

#include <string.h>

typedef struct {
    const fmi3ValueReference *references;
    size_t n, n_values;
    double *got;
    const double *given;
} values;

/** Number of variables of a kind, and of the numbers of one variable. */
static int count_of(const motion_facts *about, fmu_kind kind)
{
    switch (kind) {
    case FMU_TIME:
        return 1;
    case FMU_STATE:
    case FMU_RATE:
        return about->n_states;
    case FMU_INDICATOR:
        return about->n_indicators;
    case FMU_INPUT:
    case FMU_INPUT_RATE:
        return about->n_inputs;
    case FMU_OUTPUT:
        return about->plan->n_values;
    case FMU_PARAMETER:
        return about->n_parameters;
    }
    return 0;
}

/** Decode a reference. @return how many numbers it has; 0 if it is invalid, which is reported */
static size_t look_up(instance *self, fmi3ValueReference reference, fmu_kind *kind, int *index)
{
    const motion_facts *about = motion_about(self->motion);
    *kind = (fmu_kind)(reference >> FMU_KIND_SHIFT);
    *index = (int)(reference & ((1U << FMU_KIND_SHIFT) - 1));
    const bool is_there =
        *index < count_of(about, *kind) && (*kind != FMU_INPUT_RATE || about->inputs[*index].of.is_speed);
    if (!is_there) {
        instance_refuse(self, fmi3Error, "there is no variable with the value reference %u", (unsigned)reference);
        return 0;
    }
    return *kind == FMU_PARAMETER ? (size_t)about->parameters[*index].of.n : 1;
}

/** The numbers of a variable. NULL: not available, which is reported */
static const double *find(instance *self, fmu_kind kind, int index)
{
    const motion_facts *about = motion_about(self->motion);
    const double *all = NULL;
    dae_code code = DAE_OK;
    if (kind == FMU_INPUT || kind == FMU_INPUT_RATE) {
        const motion_input *input = &about->inputs[index];
        return kind == FMU_INPUT ? &input->value : &input->rate;
    }
    if (kind == FMU_PARAMETER) {
        return about->parameters[index].numbers;
    }
    if (self->mode == IN_INITIALIZATION && !instance_begin(self)) {
        return NULL;
    }
    switch (kind) {
    case FMU_TIME:
        return &motion_state(self->motion)->t;
    case FMU_STATE:
        return &motion_state(self->motion)->y[index];
    case FMU_RATE:
        all = motion_rates(self->motion, &code);
        break;
    case FMU_INDICATOR:
        all = motion_indicators(self->motion, &code);
        break;
    default:
        all = motion_outputs(self->motion, &code);
    }
    if (all == NULL) {
        instance_fail(self, code);
        return NULL;
    }
    return all + index;
}

/** Whether the number of values is correct, or sufficient; else report it. */
static bool suits(instance *self, const values *v, bool is_so)
{
    if (!is_so) {
        instance_refuse(self, fmi3Error, "these variables do not have %zu values", v->n_values);
    }
    return is_so;
}

static void get(instance *self, void *with)
{
    const values *v = with;
    size_t n_done = 0;
    for (size_t i = 0; i < v->n; i++) {
        fmu_kind kind;
        int index;
        const size_t n = look_up(self, v->references[i], &kind, &index);
        const bool is_settable = kind == FMU_INPUT || kind == FMU_INPUT_RATE || kind == FMU_PARAMETER;
        if (n == 0) {
            return;
        }
        if (self->mode == IN_INSTANTIATED && !is_settable) {
            instance_refuse(self, fmi3Error, "before the initialization only parameters and inputs have values");
            return;
        }
        if (!suits(self, v, n <= v->n_values - n_done)) {
            return;
        }
        const double *from = find(self, kind, index);
        if (from == NULL) {
            return;
        }
        memcpy(v->got + n_done, from, n * sizeof *from);
        n_done += n;
    }
    (void)suits(self, v, n_done == v->n_values);
}

fmi3Status fmi3GetFloat64(fmi3Instance handle, const fmi3ValueReference references[], size_t n, fmi3Float64 got[],
                          size_t n_values)
{
    const unsigned modes = IN_ANY & ~(unsigned)IN_CONFIGURATION;
    return instance_call(handle, "fmi3GetFloat64", modes, get, &(values){references, n, n_values, got, NULL});
}

static void put(instance *self, fmu_kind kind, int index, const double *from)
{
    const bool before = ((unsigned)self->mode & (IN_INSTANTIATED | IN_INITIALIZATION)) != 0;
    if (kind == FMU_PARAMETER && before) {
        motion_set_parameter(self->motion, index, from);
        self->is_begun = false;
    } else if (kind == FMU_INPUT || kind == FMU_INPUT_RATE) {
        motion_set_input(self->motion, index, kind == FMU_INPUT_RATE, *from);
        self->is_begun = self->is_begun && !before;
    } else {
        instance_refuse(self, fmi3Error,
                        kind == FMU_PARAMETER ? "parameters are set before the initialization is left"
                                              : "only inputs and parameters can be set");
    }
}

static void set(instance *self, void *with)
{
    const values *v = with;
    size_t n_done = 0;
    for (size_t i = 0; i < v->n && self->status == fmi3OK; i++) {
        fmu_kind kind;
        int index;
        const size_t n = look_up(self, v->references[i], &kind, &index);
        if (!suits(self, v, n <= v->n_values - n_done)) {
            return;
        }
        if (n > 0 && instance_are_finite(self, n, v->given + n_done)) {
            put(self, kind, index, v->given + n_done);
        }
        n_done += n;
    }
    if (self->status == fmi3OK) {
        (void)suits(self, v, n_done == v->n_values);
    }
}

fmi3Status fmi3SetFloat64(fmi3Instance handle, const fmi3ValueReference references[], size_t n,
                          const fmi3Float64 given[], size_t n_values)
{
    return instance_call(handle, "fmi3SetFloat64", IN_MOTION | IN_INSTANTIATED | IN_INITIALIZATION, set,
                         &(values){references, n, n_values, NULL, given});
}
