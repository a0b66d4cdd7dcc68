#include "batch/batch_plan.h"

#include "base/json.h"
#include "base/memory.h"
#include "base/suggest.h"
#include "base/words.h"
#include "batch/journal_line.h"
#include "batch/response_table.h"
#include "simulate/metric_rows.h"

#include <evolvent_version.h>
#include <stdlib.h>
#include <string.h>

/** A path that does not exist in any case is an error of the design; a refused value is one of its row. */
static bool check_paths(const batch_plan *plan, evl_error *error)
{
    const design *design = plan->design;
    for (int i = 0; i < design->n_columns; i++) {
        evl_error reason;
        const char *path = design->columns[i].path;
        if (strchr(path, '=') != NULL || !case_base_has_path(plan->base, path, &reason)) {
            return evl_error_set(error, EVL_EXIT_CASE, design->file, "no case has the path '%.200s': %s", path,
                                 strchr(path, '=') != NULL ? "it contains '='" : reason.message);
        }
    }
    return true;
}

/** Whether a case of the plan may start on a periodic orbit. */
static bool some_are_periodic(const batch_plan *plan)
{
    static const char path[] = "simulation.initial";
    const char *kind = case_base_text(plan->base, "simulation.initial.kind");
    bool some = kind != NULL && strcmp(kind, "periodic") == 0;
    for (int i = 0; i < plan->design->n_columns; i++) {
        some = some || strncmp(plan->design->columns[i].path, path, strlen(path)) == 0;
    }
    return some;
}

/** Check a design of responses. */
static bool check_responses(const design *design, evl_error *error)
{
    const char *direction = design->respond_direction;
    if (strcmp(direction, "up") != 0 && strcmp(direction, "down") != 0 && strcmp(direction, "both") != 0) {
        return evl_error_set(error, EVL_EXIT_CASE, design->file,
                             "respond_direction: is '%.64s', must be up, down or both", direction);
    }
    return design->history_variables[0] == '\0' ||
           evl_error_set(error, EVL_EXIT_CASE, design->file, "history_variables: responses have no histories");
}

static bool take_table(batch_plan *plan, evl_error *error)
{
    memory_arena *arena = &plan->arena;
    model_names names = {0};
    names.meshes.names = case_base_elements(plan->base, "meshes", arena, &names.meshes.n);
    names.wheels.names = case_base_elements(plan->base, "wheels", arena, &names.wheels.n);
    names.accelerometers.names =
        case_base_elements(plan->base, "housing.accelerometers", arena, &names.accelerometers.n);
    CLEANUP_FREE char **words = NULL;
    const int n = words_split(plan->design->metrics, &words);
    const bool responds = plan->design->respond_over[0] != '\0';
    if (responds && !check_responses(plan->design, error)) {
        return false;
    }
    const char *unknown =
        responds ? response_table_init(&plan->table, &names, n, (const char *const *)words)
                 : statistics_table_init(&plan->table, &names, n, (const char *const *)words, some_are_periodic(plan));
    plan->needs_roots = strstr(plan->design->history_variables, "root_stress_") != NULL;
    plan->needs_roots = plan->needs_roots || metric_rows_request(plan->table.taken, METRIC_OF_ROOTS);
    plan->needs_temperatures = strstr(plan->design->history_variables, "_temperature") != NULL ||
                               metric_rows_request(plan->table.taken, METRIC_OF_TEMPERATURES);
    if (unknown == NULL && responds && (plan->needs_roots || plan->needs_temperatures)) {
        return evl_error_set(error, EVL_EXIT_CASE, plan->design->file,
                             "metrics: responses have no metrics of the %s; run the values one by one",
                             plan->needs_roots ? "root stress" : "temperatures");
    }
    if (unknown == NULL) {
        return true;
    }
    CLEANUP_FREE char *known = metric_rows_words();
    return evl_error_set(error, EVL_EXIT_CASE, plan->design->file,
                         "metrics: unknown metric '%.64s'; known are %s, and those of docs/guides/signals.md", unknown,
                         known);
}

bool batch_plan_case(const batch_plan *plan, long index, case_plan *of_case, evl_error *error)
{
    const design *design = plan->design;
    ARENA_SCOPE memory_arena arena = {NULL};
    const char **options = arena_calloc(&arena, (size_t)design->n_columns, sizeof *options);
    for (int i = 0; i < design->n_columns; i++) {
        options[i] = design_option(design, i, index, &arena);
    }
    const plan_request request = {.base = plan->base,
                                  .n_set = design->n_columns,
                                  .set = options,
                                  .wheels = wheel_store_door(plan->wheels),
                                  .roots = plan->needs_roots ? PLAN_ROOT_OUTPUTS : PLAN_ROOTS_OF_CASE,
                                  .needs_temperatures = plan->needs_temperatures};
    return case_plan_make(of_case, &request, error);
}

/* ---- histories ---- */

static bool refuse_variable(const batch_plan *plan, const model *model, const char *name, evl_error *error)
{
    const int n = model_about(model)->n_outputs;
    CLEANUP_FREE const char **names = xcalloc((size_t)n, sizeof *names);
    int n_names = 0;
    for (int i = 0; i < n; i++) {
        const model_output *output = &model_about(model)->outputs[i];
        if (!output->is_static && output->count > 0) {
            names[n_names++] = output->name;
        }
    }
    CLEANUP_FREE char *hint = suggest_phrase(name, n_names, names);
    return evl_error_set(error, EVL_EXIT_CASE, plan->design->file,
                         "history_variables: a history of these cases has no '%.64s' over time%s", name, hint);
}

/** Find the variables by the names in the design. */
static bool choose_variables(batch_plan *plan, const model *model, evl_error *error)
{
    batch_histories *histories = &plan->histories;
    CLEANUP_FREE char *names = xstrdup(plan->design->history_variables);
    char *rest = NULL;
    histories->variables = xcalloc((size_t)model_about(model)->n_outputs + 1, sizeof *histories->variables);
    if (histories->axis.rule.per != NULL) {
        histories->variables[histories->n_variables++] = batch_axis_time;
    }
    for (char *name = strtok_r(names, " ", &rest); name != NULL; name = strtok_r(NULL, " ", &rest)) {
        const model_output *found = model_output_named(model, name);
        bool is_new = true;
        for (int i = 0; i < histories->n_variables; i++) {
            is_new = is_new && strcmp(histories->variables[i].name, name) != 0;
        }
        if (is_new && (found == NULL || found->is_static || found->count == 0)) {
            return refuse_variable(plan, model, name, error);
        }
        if (is_new) {
            histories->variables[histories->n_variables++] = *found;
        }
    }
    return true;
}

/** All shards must determine the same layout: it is that of the design's first case that is not refused. */
static bool plan_histories(batch_plan *plan, evl_error *error)
{
    case_plan *first = &plan->histories.first;
    evl_error refusal;
    long i = 0;
    while (i < plan->design->n_cases && !batch_plan_case(plan, i, first, &refusal)) {
        i++;
    }
    if (i == plan->design->n_cases) {
        return true; /* no case has a history */
    }
    return batch_axis_make(&plan->histories.axis, plan->design, first, error) &&
           choose_variables(plan, first->model, error);
}

/* ---- the whole plan ---- */

bool batch_plan_init(batch_plan *plan, const design *design, evl_error *error)
{
    *plan = (batch_plan){.design = design, .stack = {.descriptor = -1}};
    CLEANUP_FREE char *name = xasprintf("%s: base case", design->file);
    plan->base = case_base_parse(name, design->base_case, model_schema(), error);
    if (plan->base == NULL) {
        return false;
    }
    plan->wheels = wheel_store_create();
    if (!take_table(plan, error) || !check_paths(plan, error) ||
        (design->history_variables[0] != '\0' && !plan_histories(plan, error))) {
        batch_plan_free(plan);
        return false;
    }
    return true;
}

void batch_plan_free(batch_plan *plan)
{
    batch_histories *histories = &plan->histories;
    case_plan_free(&histories->first);
    free(histories->variables);
    batch_axis_free(&histories->axis);
    stack_close(&plan->stack);
    arena_free(&plan->table.arena);
    arena_free(&plan->arena);
    wheel_store_delete(&plan->wheels);
    case_base_delete(&plan->base);
}

char *batch_plan_head(const batch_plan *plan, int shard, int n_shards)
{
    char *text = NULL;
    size_t length = 0;
    json_writer writer = {.stream = memory_open(&text, &length), .is_line = true};
    json_open(&writer, NULL, '{');
    json_integer(&writer, "journal", JOURNAL_FORMAT);
    json_text(&writer, "design", plan->design->hash);
    json_integer(&writer, "shard", shard);
    json_integer(&writer, "of", n_shards);
    json_integer(&writer, "n_cases", plan->design->n_cases);
    json_text(&writer, "evolvent", EVOLVENT_VERSION);
    json_open(&writer, "scalars", '[');
    for (int i = 0; i < plan->table.n; i++) {
        const statistics_scalar *scalar = &plan->table.scalars[i];
        json_open(&writer, NULL, '{');
        json_text(&writer, "name", scalar->name);
        json_text(&writer, "units", scalar->units);
        json_text(&writer, "long_name", scalar->long_name);
        json_close(&writer, '}');
    }
    json_close(&writer, ']');
    json_close(&writer, '}');
    memory_close(writer.stream, &text);
    text[length - 1] = '\0'; /* the newline */
    return text;
}
