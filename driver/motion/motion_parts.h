/** Shared by the files of the module. */
#pragma once

#include "integrate/progress_rate.h"
#include "motion/motion_types.h"

struct motion {
    memory_arena arena; /**< owns all arrays */
    char *name, *text;  /**< of the case, to create it again with other parameters */
    case_plan plan;
    const dae *dae;
    motion_facts about;
    model_sampler *sampler;
    dae_state now;                /**< the state visible to the caller */
    dae_state reach;              /**< end of the stepper's last step, where its events are not applied yet */
    dae_state old;                /**< before an event */
    void *stepper;                /**< NULL: the caller integrates */
    bool at_event, at_time_event; /**< of `reach` */
    double t_end;
    int *fired, *directions;
    dae_event *events;
    double *roots, *values;
    bool has_outputs; /**< `values` belong to `now` */
    bool is_altered;  /**< the model has other parameters than the text */
    progress_rate progress_rate;
    char message[DAE_MESSAGE_LENGTH];
    evl_error error;
};

/** Report why a motion failed at its time. @return false */
bool motion_fail(motion *motion, const char *reason);
/** Report that the speed set for an input has jumped from that of its wheel. @return false */
bool motion_fail_speed(motion *motion, const motion_input *input, double turns);
/** Apply the fired events at a state. @return false with the reason */
bool motion_apply(motion *motion, dae_state *state, bool time_event);
/** Create the model again if parameters have changed since. */
bool motion_renew(motion *motion);
/** Create a stepper without starting it. @return false with the reason */
bool motion_make_stepper(motion *motion);
void motion_stop_stepper(motion *motion);
