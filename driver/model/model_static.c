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

/** First pitch and number of pitches of a span. @return false if they do not fit into an integer */
static bool find_pitches(const static_span *span, int *first, int *pitches)
{
    static const double farthest = 1e9;
    if (!(fmax(fabs(span->from), fabs(span->to)) < farthest)) {
        return false;
    }
    *first = (int)floor(span->from);
    const int n = (int)ceil(span->to) - *first;
    *pitches = n > 0 ? n : 1;
    return true;
}

double model_static_pair_force(const model *model, int mesh, const static_span *span)
{
    double force = NAN;
    int first, pitches;
    const bool good =
        find_pitches(span, &first, &pitches) &&
        evl_gearbox_static_largest(model->gearbox, mesh, first, pitches, span->torque, &force, NULL) == EVL_OK;
    return good ? force : NAN;
}

double model_static_root(const model *model, int wheel, const static_span *spans)
{
    const int n = model->about.names.meshes.n;
    CLEANUP_FREE int *first = xcalloc((size_t)n, sizeof *first), *pitches = xcalloc((size_t)n, sizeof *pitches);
    CLEANUP_FREE double *torques = xcalloc((size_t)n, sizeof *torques);
    double stress = NAN;
    bool good = true;
    for (int m = 0; m < n; m++) {
        good = good && find_pitches(&spans[m], &first[m], &pitches[m]);
        torques[m] = spans[m].torque;
    }
    good = good && evl_gearbox_static_root(model->gearbox, wheel, first, pitches, torques, &stress, NULL) == EVL_OK;
    return good ? stress : NAN;
}
