/* Contents of a motion, and its start. */
#include "motion/motion.h"

#include "base/interrupt.h"
#include "base/number.h"
#include "motion/motion_parts.h"
#include "simulate/case_start.h"

#include <float.h>
#include <stdio.h>
#include <string.h>

/** Exclude parameters of a case that do not apply to a motion: its end and outputs are determined by the caller. */
static bool is_parameter(const char *path)
{
    static const char simulation[] = "simulation.";
    return strcmp(path, "format") != 0 &&
           (strncmp(path, simulation, strlen(simulation)) != 0 || strcmp(path, "simulation.tolerance") == 0 ||
            strcmp(path, "simulation.max_step") == 0 || strncmp(path, "simulation.initial.", 19) == 0);
}

static void find_parameters(motion *m)
{
    const model *model = m->plan.model;
    evl_parameter parameter;
    double *numbers = NULL;
    int n = 0;
    for (int i = 0; (numbers = model_parameter_at(model, i, &parameter)) != NULL; i++) {
        free(numbers);
        n++;
    }
    m->about.parameters = arena_calloc(&m->arena, (size_t)n, sizeof *m->about.parameters);
    for (int i = 0; (numbers = model_parameter_at(model, i, &parameter)) != NULL; i++) {
        if (is_parameter(parameter.path)) {
            motion_parameter *own = &m->about.parameters[m->about.n_parameters++];
            *own = (motion_parameter){parameter, model_schema()->rows[parameter.row].text,
                                      arena_calloc(&m->arena, (size_t)parameter.n, sizeof *numbers), false};
            memcpy(own->numbers, numbers, (size_t)parameter.n * sizeof *numbers);
        }
        free(numbers);
    }
}

static void find_inputs(motion *m)
{
    model_input *inputs;
    const int n = model_inputs(m->plan.model, &m->arena, &inputs);
    m->about.n_inputs = n;
    m->about.inputs = arena_calloc(&m->arena, (size_t)n, sizeof *m->about.inputs);
    for (int i = 0; i < n; i++) {
        m->about.inputs[i] = (motion_input){.of = inputs[i], .value = inputs[i].value};
    }
}

/** Update the references to a new model. */
static void take_model(motion *m)
{
    m->dae = &model_about(m->plan.model)->dae;
    model_sampler_delete(&m->sampler);
    m->sampler = model_sampler_create(m->plan.model, m->plan.n_outputs, m->plan.outputs);
}

static bool begin(motion *m, evl_error *error)
{
    model_message refusal;
    m->about.plan = &m->plan;
    if (model_about(m->plan.model)->dae.stepper == NULL) {
        model_explain_no_stepper(m->plan.model, &refusal);
        return case_plan_refuse(&m->plan, &refusal, error);
    }
    m->name = xstrdup(m->plan.path);
    m->text = xstrdup(case_text(m->plan.file));
    find_parameters(m);
    find_inputs(m);
    take_model(m);
    const dae *dae = m->dae;
    m->about.n_states = dae->n;
    m->about.n_indicators = dae->n_roots;
    m->now = dae_state_create(dae, &m->arena);
    m->reach = dae_state_create(dae, &m->arena);
    m->old = dae_state_create(dae, &m->arena);
    m->fired = arena_calloc(&m->arena, (size_t)dae->n_roots, sizeof *m->fired);
    m->directions = arena_calloc(&m->arena, (size_t)dae->n_roots, sizeof *m->directions);
    m->roots = arena_calloc(&m->arena, (size_t)dae->n_roots, sizeof *m->roots);
    m->events = arena_calloc(&m->arena, (size_t)dae->n_events, sizeof *m->events);
    m->values = arena_calloc(&m->arena, (size_t)m->plan.n_values, sizeof *m->values);
    m->t_end = DBL_MAX;
    return true;
}

motion *motion_create(case_plan *plan, evl_error *error)
{
    motion *m = xcalloc(1, sizeof *m);
    m->plan = *plan;
    *plan = (case_plan){0};
    if (!begin(m, error)) {
        motion_delete(&m);
    }
    return m;
}

motion *motion_read(const char *name, const char *text, evl_error *error)
{
    case_plan plan = {0};
    if (!case_plan_make(&plan, &(plan_request){.name = name, .text = text}, error)) {
        case_plan_free(&plan);
        return NULL;
    }
    return motion_create(&plan, error);
}

void motion_delete(motion **pointer)
{
    motion *m = *pointer;
    *pointer = NULL;
    if (m != NULL) {
        motion_stop_stepper(m);
        model_sampler_delete(&m->sampler);
        case_plan_free(&m->plan);
        free(m->name);
        free(m->text);
        arena_free(&m->arena);
        free(m);
    }
}

const motion_facts *motion_about(const motion *m)
{
    return &m->about;
}

const evl_error *motion_error(const motion *m)
{
    return &m->error;
}

/* ---- parameters and inputs ---- */

void motion_set_parameter(motion *m, int index, const double *numbers)
{
    motion_parameter *parameter = &m->about.parameters[index];
    memcpy(parameter->numbers, numbers, (size_t)parameter->of.n * sizeof *numbers);
    parameter->is_set = true;
}

void motion_set_input(motion *m, int index, bool is_rate, double value)
{
    motion_input *input = &m->about.inputs[index];
    *(is_rate ? &input->rate : &input->value) = value;
    input->is_new = true;
    m->has_outputs = false;
    if (m->stepper == NULL) {
        input->used = input->rate;
        model_feed(m->plan.model, input->of.load, input->value, input->rate);
    }
}

/** "PATH=VALUE" in the form of an option. */
static char *option_of(memory_arena *arena, const motion_parameter *parameter)
{
    char *text = arena_printf(arena, "%s=%s", parameter->of.path, parameter->of.n == 1 ? "" : "[");
    for (int i = 0; i < parameter->of.n; i++) {
        char number[NUMBER_TEXT_LENGTH];
        number_write(number, parameter->numbers[i]);
        text = arena_printf(arena, "%s%s%s", text, i == 0 ? "" : ", ", number);
    }
    return parameter->of.n == 1 ? text : arena_printf(arena, "%s]", text);
}

static bool is_alike(const motion *m, const model *other)
{
    const model_facts *now = model_about(m->plan.model), *then = model_about(other);
    bool is_alike = then->dae.stepper != NULL && now->dae.n == then->dae.n && now->dae.n_roots == then->dae.n_roots &&
                    now->dae.n_integers == then->dae.n_integers && now->dae.n_reals == then->dae.n_reals &&
                    now->n_outputs == then->n_outputs && now->dae.n_events == then->dae.n_events;
    for (int i = 0; i < now->n_outputs && is_alike; i++) {
        is_alike = now->outputs[i].count == then->outputs[i].count;
    }
    return is_alike;
}

bool motion_renew(motion *m)
{
    ARENA_SCOPE memory_arena arena = {NULL};
    const int n = m->about.n_parameters;
    const char **set = arena_calloc(&arena, (size_t)n, sizeof *set);
    int n_set = 0;
    for (int i = 0; i < n; i++) {
        if (m->about.parameters[i].is_set) {
            set[n_set++] = option_of(&arena, &m->about.parameters[i]);
        }
    }
    if (n_set == 0 && !m->is_altered) {
        return true;
    }
    case_plan other = {0};
    const plan_request request = {.name = m->name, .text = m->text, .n_set = n_set, .set = set};
    bool good = case_plan_make(&other, &request, &m->error);
    if (good && !is_alike(m, other.model)) {
        good = evl_error_set(&m->error, EVL_EXIT_CASE, m->name,
                             "with these parameters the gearbox has other states, tooth pairs or outputs; change the "
                             "case, and generate its importer again");
    }
    if (good) {
        motion_stop_stepper(m);
        const case_plan before = m->plan;
        m->plan = other;
        other = before;
        take_model(m);
        m->is_altered = n_set > 0;
    }
    case_plan_free(&other);
    return good;
}

/* ---- start ---- */

static void feed(const motion *m, bool with_rates)
{
    for (int i = 0; i < m->about.n_inputs; i++) {
        motion_input *input = &m->about.inputs[i];
        input->used = with_rates ? input->rate : 0;
        input->is_new = input->is_new && !with_rates;
        model_feed(m->plan.model, input->of.load, input->value, input->used);
    }
}

bool motion_start(motion *m, bool by_steps, double t_end)
{
    m->error = (evl_error){EVL_EXIT_OK, "", ""};
    m->has_outputs = m->at_event = m->at_time_event = false;
    m->t_end = t_end;
    m->progress_rate = progress_rate_create();
    motion_stop_stepper(m);
    if (!motion_renew(m)) {
        return false;
    }
    feed(m, false);
    dae_state start;
    if (!case_start(&m->plan, &interrupt_signal, &start, NULL, &m->error)) {
        return false;
    }
    dae_state_copy(m->dae, &m->now, &start);
    dae_state_copy(m->dae, &m->reach, &start);
    dae_state_free(&start);
    feed(m, true);
    if (!by_steps) {
        return true;
    }
    return motion_make_stepper(m) &&
           (m->dae->stepper->start(m->stepper, &m->reach, m->message) == DAE_OK || motion_fail(m, m->message));
}

bool motion_reset(motion *m)
{
    for (int i = 0; i < m->about.n_parameters; i++) {
        m->about.parameters[i].is_set = false;
    }
    for (int i = 0; i < m->about.n_inputs; i++) {
        motion_input *input = &m->about.inputs[i];
        *input = (motion_input){.of = input->of, .value = input->of.value};
    }
    motion_stop_stepper(m);
    m->has_outputs = false;
    if (!motion_renew(m)) {
        return false;
    }
    double *numbers;
    evl_parameter parameter;
    int i_parameter = 0;
    for (int i = 0; (numbers = model_parameter_at(m->plan.model, i, &parameter)) != NULL; i++) {
        if (is_parameter(parameter.path)) {
            memcpy(m->about.parameters[i_parameter++].numbers, numbers, (size_t)parameter.n * sizeof *numbers);
        }
        free(numbers);
    }
    return true;
}
