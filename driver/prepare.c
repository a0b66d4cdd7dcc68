#include "prepare.h"

void prepare_refuse(const prepared_case *prepared, const model_error *refusal, evl_error *error)
{
    static const case_subject subjects[] = {
        [MODEL_ABOUT_NOTHING] = CASE_ABOUT_NOTHING, [MODEL_ABOUT_WHEEL] = CASE_ABOUT_WHEEL,
        [MODEL_ABOUT_MESH] = CASE_ABOUT_MESH,       [MODEL_ABOUT_LOAD] = CASE_ABOUT_LOAD,
        [MODEL_ABOUT_INITIAL] = CASE_ABOUT_INITIAL, [MODEL_ABOUT_HOUSING] = CASE_ABOUT_HOUSING,
        [MODEL_ABOUT_SHAFT] = CASE_ABOUT_SHAFT,
    };
    case_refuse(prepared->file, subjects[refusal->subject], refusal->index, refusal->load, refusal->field,
                refusal->message, error);
}

/** The case's integrator, or the one that suits the model. @return false if it asks for one that does not serve */
static bool settle_integrator(const prepared_case *prepared, model_error *refusal)
{
    const simulation_description *simulation = &case_description(prepared->file)->simulation;
    const bool serves = model_dae(prepared->model)->stepper != NULL;
    if (simulation->integrator == INTEGRATOR_RADAU && !serves) {
        model_explain_no_stepper(prepared->model, refusal);
        return false;
    }
    case_settle_integrator(prepared->file, serves && simulation->tolerance >= RADAU_SMALLEST_TOLERANCE
                                               ? INTEGRATOR_RADAU
                                               : INTEGRATOR_IDA);
    return true;
}

bool prepare_case(prepared_case *prepared, const char *path, int n_set, const char *const *set, evl_error *error)
{
    model_error refusal;
    *prepared = (prepared_case){.file = case_read(path, n_set, set, model_laws(), error)};
    if (prepared->file == NULL) {
        return false;
    }
    prepared->model = model_create(case_description(prepared->file), &refusal);
    if (prepared->model == NULL) {
        prepare_refuse(prepared, &refusal, error);
        case_delete(&prepared->file);
        return false;
    }
    if (!settle_integrator(prepared, &refusal)) {
        prepare_refuse(prepared, &refusal, error);
        prepared_case_free(prepared);
        return false;
    }
    return true;
}

void prepared_case_free(prepared_case *prepared)
{
    model_delete(&prepared->model);
    case_delete(&prepared->file);
}
