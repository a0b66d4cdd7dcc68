#include "simulate/prepare.h"

#include "base/interrupt.h"
#include "base/memory.h"
#include "base/words.h"
#include "model/model_start.h"
#include "model/output_groups.h"
#include "simulate/positions.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Errors of the penetration as a function of the tolerance, the largest found by `python benchmarks/stated_accuracy.py
 * --measure`: factor * tolerance^power. Radau controls its steps by tolerance^(4/7), and its errors follow. The law of
 * ida excludes gears that lose contact repeatedly. */
typedef struct {
    double factor, power;
} error_law;

static const error_law radau = {1.4e-3, 4.0 / 7}, ida = {10.0, 5.0 / 6};
static const double largest_tolerance = 1e-3; /* that a case may specify */

/** Tolerance of an integrator, in units of the scales of the states.
 *  @param accuracy  error of a penetration relative to the largest one, as measured (docs/guides/integrators.md) */
static double accuracy_tolerance(double accuracy, integrator_kind integrator)
{
    const error_law *law = integrator == INTEGRATOR_RADAU ? &radau : &ida;
    char digits[16]; /* two significant digits: the same on every machine, independent of its pow() */
    (void)snprintf(digits, sizeof digits, "%.1e", pow(accuracy / law->factor, 1 / law->power));
    return fmin(strtod(digits, NULL), largest_tolerance);
}

bool prepare_refuse(const prepared_case *prepared, const model_message *refusal, evl_error *error)
{
    return case_refuse(prepared->file, refusal->field, refusal->message, error);
}

static const char **list_warnings(const prepared_case *prepared, bool with_file, memory_arena *arena, int *n)
{
    int n_of_case = 0;
    const int n_of_model = prepared->model == NULL ? 0 : model_n_warnings(prepared->model);
    const case_warning *of_case = case_warnings(prepared->file, arena, &n_of_case);
    const char **warnings = arena_calloc(arena, (size_t)n_of_case + (size_t)n_of_model, sizeof *warnings);
    *n = 0;
    for (int i = 0; i < n_of_case; i++) {
        if (with_file || of_case[i].option != NULL) {
            warnings[(*n)++] = of_case[i].text;
        }
    }
    for (int i = 0; i < n_of_model; i++) {
        model_message warning;
        model_warning(prepared->model, i, &warning);
        CLEANUP_FREE char *text = case_message(warning.field, warning.message);
        warnings[(*n)++] = arena_copy(arena, text);
    }
    return warnings;
}

const char **prepare_warning_list(const prepared_case *prepared, memory_arena *arena, int *n)
{
    return list_warnings(prepared, true, arena, n);
}

static char *join_warnings(const prepared_case *prepared, bool with_file, const char *separator)
{
    ARENA_SCOPE memory_arena arena = {NULL};
    int n = 0;
    const char **warnings = list_warnings(prepared, with_file, &arena, &n);
    return words_join(n, warnings, separator);
}

char *prepare_warnings(const prepared_case *prepared, const char *separator)
{
    return join_warnings(prepared, true, separator);
}

char *prepare_own_warnings(const prepared_case *prepared, const char *separator)
{
    return join_warnings(prepared, false, separator);
}

/** Set the case's integrator, or the one suitable for the model, and its tolerance. @return false if the requested one
 *  does not support the model */
static bool settle_integrator(const prepared_case *prepared, model_message *refusal)
{
    const simulation_description *simulation = &case_description(prepared->file)->simulation;
    const bool serves = model_about(prepared->model)->dae.stepper != NULL;
    if (simulation->integrator == INTEGRATOR_RADAU && !serves) {
        model_explain_no_stepper(prepared->model, refusal);
        return false;
    }
    const bool is_stated = simulation->accuracy > 0;
    const bool may_be_radau = serves && (is_stated || simulation->tolerance >= RADAU_SMALLEST_TOLERANCE);
    const integrator_kind integrator = simulation->integrator != INTEGRATOR_OPEN ? simulation->integrator
                                       : may_be_radau                            ? INTEGRATOR_RADAU
                                                                                 : INTEGRATOR_IDA;
    case_settle_simulation(prepared->file, integrator,
                           is_stated ? accuracy_tolerance(simulation->accuracy, integrator) : simulation->tolerance);
    return true;
}

/** Set the damping parameters that are left to the model. */
static void settle_damping(const prepared_case *prepared)
{
    for (int i = 0; i < case_description(prepared->file)->n_meshes; i++) {
        double parameters[MODEL_MOST_PARAMETERS];
        model_damping(prepared->model, i, parameters);
        case_settle_damping(prepared->file, i, model_schema(), parameters);
    }
}

/** Whether the outputs named in the case exist. */
static bool check_outputs(const prepared_case *prepared, model_message *refusal)
{
    const char *words = case_description(prepared->file)->simulation.outputs;
    const model_facts *about = model_about(prepared->model);
    CLEANUP_FREE bool *chosen = xcalloc((size_t)about->n_outputs, sizeof *chosen);
    CLEANUP_FREE char *why =
        words == NULL ? NULL : output_groups_choose(words, about->n_outputs, about->outputs, chosen);
    if (why != NULL) {
        *refusal = (model_message){.field = "simulation.outputs"};
        (void)snprintf(refusal->message, sizeof refusal->message, "%s", why);
    }
    return why == NULL;
}

/** Add the outputs of the root stress if the case names them, or the caller requests them. */
static bool add_root_outputs(const prepared_case *prepared, const evl_wheel_store *wheels, model_message *refusal)
{
    static const char message[] =
        "the root stress requires a wheel with finite elements; give one the key compliance: {}";
    const char *words = case_description(prepared->file)->simulation.outputs;
    const bool is_named =
        words != NULL && (strstr(words, "root_stress_max") != NULL || strstr(words, "root_stress_min") != NULL);
    if (!is_named && !prepared->needs_roots) {
        return true;
    }
    if (!model_add_root_stress(prepared->model, wheels, refusal)) {
        return false;
    }
    const bool good = model_add_root_outputs(prepared->model);
    if (!good) {
        *refusal = (model_message){.field = "simulation.outputs"};
        refusal->field[0] = is_named ? refusal->field[0] : '\0';
        (void)snprintf(refusal->message, sizeof refusal->message, "%s", message);
    }
    return good;
}

/** Create the model of a case that was read. @param before  as in model_create */
static bool make_model(prepared_case *prepared, const evl_wheel_store *wheels, model *before, evl_error *error)
{
    model_message refusal;
    prepared->model = model_create(case_description(prepared->file), wheels, before, &refusal);
    if (prepared->model == NULL || !settle_integrator(prepared, &refusal) ||
        !add_root_outputs(prepared, wheels, &refusal) || !check_outputs(prepared, &refusal)) {
        return prepare_refuse(prepared, &refusal, error);
    }
    settle_damping(prepared);
    return true;
}

bool prepare_case(prepared_case *prepared, const char *path, int n_set, const char *const *set, evl_error *error)
{
    return prepare_case_with(prepared, path, n_set, set, NULL, error);
}

bool prepare_case_with(prepared_case *prepared, const char *path, int n_set, const char *const *set,
                       const evl_wheel_store *wheels, evl_error *error)
{
    *prepared = (prepared_case){.file = case_read(path, n_set, set, model_schema(), error)};
    return prepared->file != NULL && make_model(prepared, wheels, NULL, error);
}

bool prepare_text(prepared_case *prepared, const char *name, const char *text, int n_set, const char *const *set,
                  evl_error *error)
{
    *prepared = (prepared_case){.file = case_parse(name, text, n_set, set, model_schema(), error)};
    return prepared->file != NULL && make_model(prepared, NULL, NULL, error);
}

bool prepare_root_stress(const prepared_case *prepared, const evl_wheel_store *wheels, evl_error *error)
{
    model_message refusal;
    return model_add_root_stress(prepared->model, wheels, &refusal) || prepare_refuse(prepared, &refusal, error);
}

/** Check that a state is allowed by the case's outputs. @return false with the reason in `error`; then it is freed */
static bool accept_start(const prepared_case *prepared, dae_state *state, evl_error *error)
{
    const bool good = positions_check_start(prepared, state, error);
    if (!good) {
        dae_state_free(state);
    }
    return good;
}

bool prepare_start(const prepared_case *prepared, dae_state *state, evl_error *error)
{
    return prepare_start_unless(prepared, &interrupt_signal, state, error);
}

bool prepare_start_unless(const prepared_case *prepared, const volatile sig_atomic_t *interrupt, dae_state *state,
                          evl_error *error)
{
    static const evl_exit codes[] = {[MODEL_START_FOUND] = EVL_EXIT_OK,
                                     [MODEL_START_REFUSED] = EVL_EXIT_CASE,
                                     [MODEL_START_NOT_FOUND] = EVL_EXIT_INTEGRATION,
                                     [MODEL_START_INTERRUPTED] = EVL_EXIT_INTERRUPTED};
    model_message refusal;
    const model_start_end end = model_initial_state(prepared->model, interrupt, state, &refusal);
    if (end != MODEL_START_FOUND) {
        (void)prepare_refuse(prepared, &refusal, error);
        error->code = codes[end];
        return false;
    }
    return accept_start(prepared, state, error);
}

bool prepare_check_start(const prepared_case *prepared, evl_error *error)
{
    dae_state state;
    model_message refusal;
    const bool good = model_check_start(prepared->model, &state, &refusal) ? accept_start(prepared, &state, error)
                                                                           : prepare_refuse(prepared, &refusal, error);
    if (good) {
        dae_state_free(&state);
    }
    return good;
}

bool prepare_edited(prepared_case *prepared, const case_base *base, int n_set, const char *const *set,
                    const evl_wheel_store *wheels, evl_error *error)
{
    model *before = prepared->model;
    prepared->model = NULL;
    const bool good =
        case_override(base, n_set, set, &prepared->file, error) && make_model(prepared, wheels, before, error);
    model_delete(&before);
    return good;
}

void prepared_case_free(prepared_case *prepared)
{
    model_delete(&prepared->model);
    case_delete(&prepared->file);
}
