#include "model/model_static.h"

#include "base/memory.h"
#include "model/model_kernel.h"

#include <math.h>
#include <stdlib.h>

bool model_is_of_request(const model_message *message)
{
    return message->field[0] == '\0';
}

/** Outputs of the analysis, with their offsets among the values. */
static void take_outputs(const evl_static_plan *from, static_plan *plan)
{
    evl_output *texts;
    model_output *outputs;
    const int n = model_take_outputs(EVL_TABLE_OF_STATIC, &texts, &outputs);
    CLEANUP_FREE int *offsets = xcalloc((size_t)n, sizeof *offsets), *counts = xcalloc((size_t)n, sizeof *counts);
    evl_gearbox_static_layout(from, offsets, counts);
    for (int i = 0; i < n; i++) {
        outputs[i].offset = offsets[i];
        outputs[i].count = counts[i];
        if (texts[i].dims == EVL_DIMS_HARMONIC) {
            plan->n_harmonics = counts[i];
        }
    }
    plan->n_outputs = n;
    plan->outputs = outputs;
    plan->texts = texts;
}

bool model_plan_static(const model *model, int mesh, int points, static_plan *plan, model_message *error)
{
    evl_status status = {.index = -1};
    evl_static_plan from;
    *plan = (static_plan){.mesh = mesh, .points = points};
    if (evl_gearbox_static_plan(model->gearbox, mesh, points, &from, &status) != EVL_OK) {
        model_explain(model, &status, error);
        return false;
    }
    plan->n_pitches = from.n_pitches;
    plan->n_positions = from.n_positions;
    plan->n_pairs = from.n_pairs;
    plan->first_pair = from.first_pair;
    plan->n_wheels = from.n_wheels;
    plan->n_values = from.n_values;
    plan->torque = from.torque;
    take_outputs(&from, plan);
    return true;
}

void static_plan_free(static_plan *plan)
{
    free((void *)plan->outputs);
    free(plan->texts);
    *plan = (static_plan){0};
}

bool model_static(const model *model, const static_plan *plan, double torque, double *values, model_message *error)
{
    evl_status status = {.index = -1};
    if (evl_gearbox_static(model->gearbox, plan->mesh, plan->points, torque, plan->speed, values, &status) != EVL_OK) {
        model_explain(model, &status, error);
        return false;
    }
    return true;
}

static_largest model_static_largest(const model *model, int mesh, double from, double to, double torque,
                                    bool with_roots)
{
    static const double farthest = 1e9; /* limit of positions: they must fit into an integer */
    static const static_largest none = {NAN, {NAN, NAN}};
    static_largest largest = none;
    if (!(fmax(fabs(from), fabs(to)) < farthest)) {
        return none;
    }
    const int first = (int)floor(from), pitches = (int)ceil(to) - first;
    return evl_gearbox_static_largest(model->gearbox, mesh, first, pitches > 0 ? pitches : 1, torque,
                                      &largest.pair_force, with_roots ? largest.root_stress : NULL, NULL) == EVL_OK
               ? largest
               : none;
}
