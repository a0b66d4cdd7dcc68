#include "simulate/case_plan.h"

#include "base/memory.h"
#include "base/words.h"
#include "model/model_start.h"
#include "model/output_groups.h"

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

bool case_plan_refuse(const case_plan *plan, const model_message *refusal, evl_error *error)
{
    return case_refuse(plan->file, refusal->field, refusal->message, error);
}

/** Append a warning of the model. */
static void add_warning(const model_message *warning, memory_arena *arena, const char **warnings, int *n)
{
    CLEANUP_FREE char *text = case_message(warning->field, warning->message);
    warnings[(*n)++] = arena_copy(arena, text);
}

static const char **list_warnings(const case_plan *plan, const model_start_orbit *start, bool with_file,
                                  memory_arena *arena, int *n)
{
    model_message warning;
    int n_of_case = 0;
    const int n_of_model = plan->model == NULL ? 0 : model_n_warnings(plan->model);
    const case_warning *of_case = case_warnings(plan->file, arena, &n_of_case);
    const char **warnings = arena_calloc(arena, (size_t)n_of_case + (size_t)n_of_model + 1, sizeof *warnings);
    *n = 0;
    for (int i = 0; i < n_of_case; i++) {
        if (with_file || of_case[i].option != NULL) {
            warnings[(*n)++] = of_case[i].text;
        }
    }
    for (int i = 0; i < n_of_model; i++) {
        model_warning(plan->model, i, &warning);
        add_warning(&warning, arena, warnings, n);
    }
    if (start != NULL && model_start_warning(start, &warning)) {
        add_warning(&warning, arena, warnings, n);
    }
    return warnings;
}

const char **case_plan_warning_list(const case_plan *plan, const model_start_orbit *start, memory_arena *arena, int *n)
{
    return list_warnings(plan, start, true, arena, n);
}

static char *join_warnings(const case_plan *plan, const model_start_orbit *start, bool with_file, const char *separator)
{
    ARENA_SCOPE memory_arena arena = {NULL};
    int n = 0;
    const char **warnings = list_warnings(plan, start, with_file, &arena, &n);
    return words_join(n, warnings, separator);
}

char *case_plan_warnings(const case_plan *plan, const model_start_orbit *start, const char *separator)
{
    return join_warnings(plan, start, true, separator);
}

char *case_plan_own_warnings(const case_plan *plan, const model_start_orbit *start, const char *separator)
{
    return join_warnings(plan, start, false, separator);
}

/* ---- the plan ---- */

/** Set the case's integrator, or the one suitable for the model, and its tolerance. @return false if the requested one
 *  does not support the model */
static bool settle_integrator(const case_plan *plan, model_message *refusal)
{
    const simulation_description *simulation = &plan->description->simulation;
    const bool serves = model_about(plan->model)->dae.stepper != NULL;
    if (simulation->integrator == INTEGRATOR_RADAU && !serves) {
        model_explain_no_stepper(plan->model, refusal);
        return false;
    }
    const bool is_stated = simulation->accuracy > 0;
    const bool may_be_radau = serves && (is_stated || simulation->tolerance >= RADAU_SMALLEST_TOLERANCE);
    const integrator_kind integrator = simulation->integrator != INTEGRATOR_OPEN ? simulation->integrator
                                       : may_be_radau                            ? INTEGRATOR_RADAU
                                                                                 : INTEGRATOR_IDA;
    case_settle_simulation(plan->file, integrator,
                           is_stated ? accuracy_tolerance(simulation->accuracy, integrator) : simulation->tolerance);
    return true;
}

/** Set the damping parameters that are left to the model. */
static void settle_damping(const case_plan *plan)
{
    for (int i = 0; i < plan->description->n_meshes; i++) {
        double parameters[MODEL_MOST_PARAMETERS];
        model_damping(plan->model, i, parameters);
        case_settle_damping(plan->file, i, model_schema(), parameters);
    }
}

/** Add the outputs of the root stress if the case names them, or the caller requests them. */
static bool add_root_outputs(const case_plan *plan, const plan_request *request, model_message *refusal)
{
    static const char message[] =
        "the root stress requires a wheel with finite elements; give one the key compliance: {}";
    const char *words = plan->description->simulation.outputs;
    const bool is_named =
        words != NULL && (strstr(words, "root_stress_max") != NULL || strstr(words, "root_stress_min") != NULL);
    if (!is_named && request->roots != PLAN_ROOT_OUTPUTS) {
        return true;
    }
    if (!model_add_root_stress(plan->model, request->wheels, refusal)) {
        return false;
    }
    const bool good = model_add_root_outputs(plan->model);
    if (!good) {
        *refusal = (model_message){.field = "simulation.outputs"};
        refusal->field[0] = is_named ? refusal->field[0] : '\0';
        (void)snprintf(refusal->message, sizeof refusal->message, "%s", message);
    }
    return good;
}

/** Add the outputs of the temperatures if the case names them, or the caller requests them. */
static bool add_temperature_outputs(const case_plan *plan, const plan_request *request, model_message *refusal)
{
    const char *words = plan->description->simulation.outputs;
    const bool is_named = words != NULL && (strstr(words, "pair_flash_temperature") != NULL ||
                                            strstr(words, "pair_contact_temperature") != NULL);
    return (!is_named && !request->needs_temperatures) || model_add_temperatures(plan->model, refusal);
}

/** Select the variable outputs that exist: all, or those named in the case. @return false if a name is unknown */
static bool select_outputs(case_plan *plan, model_message *refusal)
{
    const char *words = plan->description->simulation.outputs;
    const model_facts *about = model_about(plan->model);
    CLEANUP_FREE bool *chosen = xcalloc((size_t)about->n_outputs, sizeof *chosen);
    CLEANUP_FREE char *why =
        output_groups_choose(words == NULL ? "all" : words, about->n_outputs, about->outputs, chosen);
    if (why != NULL) {
        *refusal = (model_message){.field = "simulation.outputs"};
        (void)snprintf(refusal->message, sizeof refusal->message, "%s", why);
        return false;
    }
    plan->outputs = xcalloc((size_t)about->n_outputs, sizeof *plan->outputs);
    for (int i = 0; i < about->n_outputs; i++) {
        if (chosen[i] && about->outputs[i].count > 0) {
            plan->outputs[plan->n_outputs++] = i;
            plan->n_values += about->outputs[i].count;
        }
    }
    return true;
}

/** Compute what follows from the settled case. */
static void plan_run(case_plan *plan)
{
    const simulation_description *simulation = &plan->description->simulation;
    const metrics_description *metrics = &simulation->metrics;
    plan->positions = positions_of(plan->description, plan->model);
    plan->window =
        (metric_window){.from = metrics->from, .to = metrics->to, .mesh = metrics->mesh, .wheel = metrics->wheel};
    plan->integration = (integrate_options){.t_end = simulation->duration,
                                            .output_interval = simulation->output_interval,
                                            .per_unit = plan->positions.number,
                                            .position_of = plan->positions.position_of,
                                            .tolerance = simulation->tolerance,
                                            .max_step = simulation->max_step,
                                            .most_steps = simulation->most_steps,
                                            .by_stepper = simulation->integrator == INTEGRATOR_RADAU};
}

/** Read the case. */
static bool read(case_plan *plan, const plan_request *request, evl_error *error)
{
    if (request->base != NULL) {
        return case_override(request->base, request->n_set, request->set, &plan->file, error);
    }
    plan->file = request->text == NULL
                     ? case_read(request->name, request->n_set, request->set, model_schema(), error)
                     : case_parse(request->name, request->text, request->n_set, request->set, model_schema(), error);
    return plan->file != NULL;
}

bool case_plan_make(case_plan *plan, const plan_request *request, evl_error *error)
{
    model_message refusal;
    model *before = plan->model;
    free(plan->outputs);
    *plan = (case_plan){.file = plan->file};
    bool good = read(plan, request, error);
    if (good) {
        plan->description = case_description(plan->file);
        plan->path = case_path(plan->file);
        plan->model = model_create(plan->description, request->wheels, before, &refusal);
        good = (plan->model != NULL && settle_integrator(plan, &refusal) && add_root_outputs(plan, request, &refusal) &&
                add_temperature_outputs(plan, request, &refusal) && select_outputs(plan, &refusal)) ||
               case_plan_refuse(plan, &refusal, error);
    }
    model_delete(&before);
    if (!good) {
        return false;
    }
    settle_damping(plan);
    plan_run(plan);
    return request->roots != PLAN_ROOT_STRESS || model_add_root_stress(plan->model, request->wheels, &refusal) ||
           case_plan_refuse(plan, &refusal, error);
}

bool case_plan_add_root_stress(const case_plan *plan, evl_error *error)
{
    model_message refusal;
    return model_add_root_stress(plan->model, NULL, &refusal) || case_plan_refuse(plan, &refusal, error);
}

void case_plan_free(case_plan *plan)
{
    free(plan->outputs);
    model_delete(&plan->model);
    case_delete(&plan->file);
    *plan = (case_plan){0};
}
