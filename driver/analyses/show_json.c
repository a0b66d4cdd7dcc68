#include "analyses/show_json.h"

#include "analyses/show_geometry.h"
#include "base/json.h"
#include "base/memory.h"
#include "case/case_tree.h"

#include <stdlib.h>

const char *integrator_name(const simulation_description *simulation)
{
    return simulation->integrator == INTEGRATOR_RADAU ? "radau" : "ida";
}

static void write_model(json_writer *writer, const case_plan *plan)
{
    const model *model = plan->model;
    const simulation_description *simulation = &plan->description->simulation;
    json_open(writer, "integration", '{');
    json_text(writer, "integrator", integrator_name(simulation));
    json_number(writer, "tolerance", simulation->tolerance);
    json_close(writer, '}');
    write_geometry(writer, plan->description, model);
}

static void write_warnings(json_writer *writer, const case_plan *plan)
{
    ARENA_SCOPE memory_arena arena = {NULL};
    int n = 0;
    const char **warnings = case_plan_warning_list(plan, NULL, &arena, &n);
    json_open(writer, "warnings", '[');
    for (int i = 0; i < n; i++) {
        json_text(writer, NULL, warnings[i]);
    }
    json_close(writer, ']');
}

/** Write the available geometry of a refused case. */
static void write_sketch(json_writer *writer, const description *description)
{
    model *sketch = model_sketch(description);
    if (sketch != NULL) {
        write_geometry(writer, description, sketch);
    }
    model_delete(&sketch);
}

void show_json(FILE *stream, const case_plan *plan, const evl_error *refusal)
{
    json_writer writer = {.stream = stream};
    json_open(&writer, NULL, '{');
    json_text(&writer, "path", plan->path);
    tree_write_json(&writer, "case", case_root(plan->file));
    if (plan->model != NULL) {
        write_model(&writer, plan);
    } else {
        write_sketch(&writer, plan->description);
    }
    write_warnings(&writer, plan);
    CLEANUP_FREE char *line = refusal->code == EVL_EXIT_OK ? xstrdup("") : evl_error_text(refusal);
    json_text(&writer, "refusal", line);
    json_close(&writer, '}');
}

static void write_parameter(json_writer *writer, const evl_parameter *parameter, const double *numbers)
{
    json_open(writer, parameter->path, '{');
    json_text(writer, "unit", parameter->unit);
    if (parameter->n == 1) {
        json_number(writer, "value", numbers[0]);
    } else {
        json_numbers(writer, "value", parameter->n, numbers);
    }
    json_close(writer, '}');
}

void show_parameters_json(FILE *stream, const model *model)
{
    evl_parameter parameter;
    json_writer writer = {.stream = stream};
    json_open(&writer, NULL, '{');
    double *numbers = NULL;
    for (int i = 0; (numbers = model_parameter_at(model, i, &parameter)) != NULL; i++) {
        write_parameter(&writer, &parameter, numbers);
        free(numbers);
    }
    json_close(&writer, '}');
}
