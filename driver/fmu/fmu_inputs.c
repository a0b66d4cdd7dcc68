/* Selection of inputs by command line options. */
#include "base/memory.h"
#include "fmu/fmu_write.h"

#include <string.h>

static bool refuse(const char *option, const char *reason, evl_error *error)
{
    CLEANUP_FREE char *location = xasprintf("--input %s", option);
    return evl_error_set(error, EVL_EXIT_USAGE, location, "%s", reason);
}

/** The available inputs in the form of options. */
static char *list(const fmu_plan *plan)
{
    const motion_facts *about = motion_about(plan->motion);
    const char **wheels = about->plan->description->wheels;
    char *text = xstrdup("");
    for (int i = 0; i < about->n_inputs; i++) {
        const model_input *input = &about->inputs[i].of;
        CLEANUP_FREE char *before = text;
        text = xasprintf("%s%swheel:%s:%s", before, i == 0 ? "" : ", ", wheels[input->wheel],
                         input->is_speed ? "speed" : "torque");
    }
    return text;
}

static bool choose(const fmu_plan *plan, const char *option, evl_error *error)
{
    static const char start[] = "wheel:";
    const motion_facts *about = motion_about(plan->motion);
    const description *description = about->plan->description;
    const char *kind = strrchr(option, ':');
    if (strncmp(option, start, strlen(start)) != 0 || kind < option + strlen(start) ||
        (strcmp(kind, ":torque") != 0 && strcmp(kind, ":speed") != 0)) {
        return refuse(option, "an input is wheel:NAME:torque or wheel:NAME:speed", error);
    }
    const bool is_speed = strcmp(kind, ":speed") == 0;
    const char *name = option + strlen(start);
    const size_t n = (size_t)(kind - name);
    int wheel = 0;
    while (wheel < description->n_wheels &&
           (strlen(description->wheels[wheel]) != n || strncmp(description->wheels[wheel], name, n) != 0)) {
        wheel++;
    }
    for (int i = 0; i < about->n_inputs && wheel < description->n_wheels; i++) {
        const model_input *input = &about->inputs[i].of;
        if (input->wheel == wheel && input->is_speed == is_speed) {
            plan->is_chosen[i] = true;
            return true;
        }
    }
    CLEANUP_FREE char *there = list(plan);
    CLEANUP_FREE char *reason =
        wheel == description->n_wheels
            ? xasprintf("there is no wheel '%.*s'; inputs of this case are %s", (int)n, name,
                        about->n_inputs == 0 ? "none" : there)
            : xasprintf("wheel '%.*s' has no load {kind: %s, value: ...} that an input could replace; inputs of "
                        "this case are %s",
                        (int)n, name, is_speed ? "speed" : "torque", about->n_inputs == 0 ? "none" : there);
    return refuse(option, reason, error);
}

bool fmu_choose_inputs(const fmu_plan *plan, int n, const char *const *options, evl_error *error)
{
    for (int i = 0; i < n; i++) {
        if (!choose(plan, options[i], error)) {
            return false;
        }
    }
    return true;
}
