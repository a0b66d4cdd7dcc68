/* modelDescription.xml of FMI 3.0, by Mini-XML. */
#include "base/memory.h"
#include "base/number.h"
#include "base/words.h"
#include "case/former_keys.h"
#include "case/unit_spelling.h"
#include "files/dimensions.h"
#include "fmu/fmu_write.h"

#include <evolvent_version.h>
#include <mxml.h>
#include <stdio.h>
#include <string.h>

typedef struct {
    const fmu_plan *plan;
    const motion_facts *about;
    const model_facts *model;
    memory_arena arena;
    mxml_node_t *units, *variables, *structure, *initial;
    int n_units;
    const char **unit_names; /**< units defined so far */
} writer;

static mxml_node_t *add(mxml_node_t *parent, const char *name)
{
    mxml_node_t *node = mxmlNewElement(parent, name);
    if (node == NULL) {
        evl_memory_run_out(1, 1);
    }
    return node;
}

static void put_number(mxml_node_t *node, const char *name, double value)
{
    char text[NUMBER_TEXT_LENGTH];
    number_write_plain(text, value);
    mxmlElementSetAttr(node, name, text);
}

static void put_reference(mxml_node_t *node, const char *name, unsigned reference)
{
    char text[16];
    (void)snprintf(text, sizeof text, "%u", reference);
    mxmlElementSetAttr(node, name, text);
}

/** Set the unit of a variable, in the spelling of results; it is defined at its first use. */
static void put_unit(writer *w, mxml_node_t *variable, const char *name)
{
    if (name[0] == '\0' || strcmp(name, "1") == 0) {
        return;
    }
    CLEANUP_FREE char *unit = unit_of_results(name);
    mxmlElementSetAttr(variable, "unit", unit);
    if (words_index(unit, w->n_units, w->unit_names) < 0) {
        w->unit_names =
            arena_grow(&w->arena, w->unit_names, (size_t)w->n_units, (size_t)w->n_units + 1, sizeof *w->unit_names);
        w->unit_names[w->n_units++] = arena_copy(&w->arena, unit);
        mxmlElementSetAttr(add(w->units, "Unit"), "name", unit);
    }
}

static mxml_node_t *add_variable(writer *w, const char *name, unsigned reference, const char *causality,
                                 const char *variability, const char *description)
{
    mxml_node_t *variable = add(w->variables, "Float64");
    mxmlElementSetAttr(variable, "name", name);
    put_reference(variable, "valueReference", reference);
    mxmlElementSetAttr(variable, "causality", causality);
    mxmlElementSetAttr(variable, "variability", variability);
    if (description[0] != '\0') {
        mxmlElementSetAttr(variable, "description", description);
    }
    return variable;
}

static void add_unknown(mxml_node_t *parent, const char *name, unsigned reference)
{
    put_reference(add(parent, name), "valueReference", reference);
}

/* ---- variables ---- */

static void add_parameters(writer *w)
{
    for (int i = 0; i < w->about->n_parameters; i++) {
        const motion_parameter *parameter = &w->about->parameters[i];
        bool is_input = false;
        for (int k = 0; k < w->about->n_inputs; k++) {
            is_input =
                is_input || (w->plan->is_chosen[k] && strcmp(w->about->inputs[k].of.path, parameter->of.path) == 0);
        }
        if (is_input) {
            continue;
        }
        mxml_node_t *variable =
            add_variable(w, parameter->of.path, fmu_reference(FMU_PARAMETER, i), "parameter", "fixed", parameter->text);
        put_unit(w, variable, parameter->of.unit);
        char *start = arena_copy(&w->arena, "");
        for (int k = 0; k < parameter->of.n; k++) {
            char number[NUMBER_TEXT_LENGTH];
            number_write_plain(number, parameter->numbers[k]);
            start = arena_printf(&w->arena, "%s%s%s", start, k == 0 ? "" : " ", number);
        }
        mxmlElementSetAttr(variable, "start", start);
        if (parameter->of.n > 1) {
            put_reference(add(variable, "Dimension"), "start", (unsigned)parameter->of.n);
        }
        CLEANUP_FREE char *former = path_with_former_keys(parameter->of.path);
        if (former != NULL) {
            mxmlElementSetAttr(add(variable, "Alias"), "name", former);
        }
    }
}

static void add_inputs(writer *w)
{
    const char **wheels = w->about->plan->description->wheels;
    for (int i = 0; i < w->about->n_inputs; i++) {
        const motion_input *input = &w->about->inputs[i];
        const char *wheel = wheels[input->of.wheel];
        if (!w->plan->is_chosen[i]) {
            continue;
        }
        mxml_node_t *variable =
            add_variable(w, arena_printf(&w->arena, "%s.%s", wheel, input->of.is_speed ? "speed" : "torque"),
                         fmu_reference(FMU_INPUT, i), "input", "continuous",
                         input->of.is_speed ? "angular velocity of the wheel, counterclockwise positive; continuous"
                                            : "torque on the wheel, counterclockwise positive");
        put_number(variable, "start", input->value);
        put_unit(w, variable, input->of.is_speed ? "rad s-1" : "N m");
        if (input->of.is_speed) {
            mxml_node_t *rate =
                add_variable(w, arena_printf(&w->arena, "%s.acceleration", wheel), fmu_reference(FMU_INPUT_RATE, i),
                             "input", "continuous", "rate of that speed");
            put_number(rate, "start", 0);
            put_reference(rate, "derivative", fmu_reference(FMU_INPUT, i));
            put_unit(w, rate, "rad s-2");
        }
    }
}

/** "name[gear,x]": the output with the names of the value's elements. */
static char *name_of(writer *w, const model_output *output, dimensions *all, int index)
{
    const netcdf_variable variable = dimensions_describe(all, output);
    char *text = arena_copy(&w->arena, "");
    int rest = index;
    for (int i = variable.rank - 1; i >= 0; i--) {
        const int length = (int)variable.dimensions[i]->length;
        const long which = variable.dimensions[i] - all->of;
        text = arena_printf(&w->arena, "%s%s%s", all->values[which].names[rest % length], text[0] == '\0' ? "" : ",",
                            text);
        rest /= length;
    }
    return text[0] == '\0' ? arena_copy(&w->arena, output->name)
                           : arena_printf(&w->arena, "%s[%s]", output->name, text);
}

static void add_outputs(writer *w)
{
    dimensions all = {0};
    int i_value = 0;
    dimensions_plan(&all, DIMENSIONS_OF_STACK, &w->model->names, w->model->n_outputs, w->model->outputs);
    for (int i = 0; i < w->about->plan->n_outputs; i++) {
        const model_output *output = &w->model->outputs[w->about->plan->outputs[i]];
        for (int k = 0; k < output->count; k++, i_value++) {
            const unsigned reference = fmu_reference(FMU_OUTPUT, i_value);
            mxml_node_t *variable =
                add_variable(w, name_of(w, output, &all, k), reference, "output", "continuous", output->long_name);
            put_unit(w, variable, output->units);
            add_unknown(w->structure, "Output", reference);
            add_unknown(w->initial, "InitialUnknown", reference);
        }
    }
}

static void add_states(writer *w)
{
    const double *scales = motion_scales(w->plan->motion);
    CLEANUP_FREE model_state *states = model_states(w->about->plan->model);
    for (int i = 0; i < w->about->n_states; i++) {
        const unsigned state = fmu_reference(FMU_STATE, i), rate = fmu_reference(FMU_RATE, i);
        mxml_node_t *variable =
            add_variable(w, arena_printf(&w->arena, "state.%s", states[i].name), state, "local", "continuous", "state");
        mxmlElementSetAttr(variable, "initial", "calculated");
        mxmlElementSetAttr(variable, "reinit", "true");
        put_unit(w, variable, states[i].units);
        put_number(variable, "nominal", scales[i]);
        variable = add_variable(w, arena_printf(&w->arena, "der(state.%s)", states[i].name), rate, "local",
                                "continuous", "its rate");
        mxmlElementSetAttr(variable, "initial", "calculated");
        put_reference(variable, "derivative", state);
        add_unknown(w->structure, "ContinuousStateDerivative", rate);
        add_unknown(w->initial, "InitialUnknown", state);
        add_unknown(w->initial, "InitialUnknown", rate);
    }
}

static void add_indicators(writer *w)
{
    for (int i = 0; i < w->about->n_indicators; i++) {
        add_variable(w, arena_printf(&w->arena, "event_indicator[%d]", i), fmu_reference(FMU_INDICATOR, i), "local",
                     "continuous", "event indicator: an event occurs at a change of sign; 1 if inactive");
    }
}

/* ---- the complete document ---- */

static void describe_kinds(mxml_node_t *root)
{
    static const char *const kinds[] = {"ModelExchange", "CoSimulation"};
    for (int i = 0; i < 2; i++) {
        mxml_node_t *kind = add(root, kinds[i]);
        mxmlElementSetAttr(kind, "modelIdentifier", FMU_MODEL_IDENTIFIER);
        mxmlElementSetAttr(kind, "canGetAndSetFMUState", "true");
        mxmlElementSetAttr(kind, "canSerializeFMUState", "true");
        if (i == 0) {
            mxmlElementSetAttr(kind, "needsCompletedIntegratorStep", "true");
        } else {
            mxmlElementSetAttr(kind, "canHandleVariableCommunicationStepSize", "true");
        }
    }
}

static void describe_experiment(const writer *w, mxml_node_t *root)
{
    const integrate_options *run = &w->about->plan->integration;
    mxml_node_t *experiment = add(root, "DefaultExperiment");
    put_number(experiment, "startTime", 0);
    put_number(experiment, "stopTime", run->t_end);
    if (run->output_interval > 0) {
        put_number(experiment, "stepSize", run->output_interval);
    }
}

static void describe_log(mxml_node_t *root)
{
    static const char *const categories[] = {"logStatusError", "logStatusFatal"};
    mxml_node_t *log = add(root, "LogCategories");
    for (int i = 0; i < 2; i++) {
        mxmlElementSetAttr(add(log, "Category"), "name", categories[i]);
    }
}

static mxml_node_t *describe(writer *w)
{
    char token[SHA256_TEXT];
    const char *title = w->about->plan->description->title;
    mxml_node_t *document = mxmlNewXML("1.0");
    if (document == NULL) {
        evl_memory_run_out(1, 1);
    }
    mxml_node_t *root = add(document, "fmiModelDescription");
    fmu_token(w->about->plan->file, token);
    mxmlElementSetAttr(root, "fmiVersion", "3.0");
    mxmlElementSetAttr(root, "modelName", w->plan->name);
    mxmlElementSetAttr(root, "instantiationToken", token);
    if (title[0] != '\0') {
        mxmlElementSetAttr(root, "description", title);
    }
    mxmlElementSetAttr(root, "generationTool", "evolvent " EVOLVENT_VERSION);
    mxmlElementSetAttr(root, "variableNamingConvention", "flat");
    describe_kinds(root);
    w->units = add(root, "UnitDefinitions");
    describe_log(root);
    describe_experiment(w, root);
    w->variables = add(root, "ModelVariables");
    w->structure = add(root, "ModelStructure");
    w->initial = add(NULL, "InitialUnknowns"); /* to be appended last */
    mxml_node_t *time = add_variable(w, "time", fmu_reference(FMU_TIME, 0), "independent", "continuous", "");
    put_unit(w, time, "s");
    add_inputs(w);
    add_parameters(w);
    add_outputs(w);
    add_states(w);
    add_indicators(w);
    for (mxml_node_t *node = mxmlGetFirstChild(w->initial); node != NULL; node = mxmlGetFirstChild(w->initial)) {
        mxmlAdd(w->structure, MXML_ADD_AFTER, NULL, node);
    }
    for (int i = 0; i < w->about->n_indicators; i++) {
        add_unknown(w->structure, "EventIndicator", fmu_reference(FMU_INDICATOR, i));
    }
    mxmlDelete(w->initial);
    return document;
}

char *fmu_description(const fmu_plan *plan)
{
    writer w = {.plan = plan, .about = motion_about(plan->motion)};
    w.model = model_about(w.about->plan->model);
    mxml_node_t *document = describe(&w);
#if MXML_MAJOR_VERSION >= 4
    char *text = mxmlSaveAllocString(document, NULL);
#else
    char *text = mxmlSaveAllocString(document, MXML_NO_CALLBACK);
#endif
    mxmlDelete(document);
    arena_free(&w.arena);
    if (text == NULL) {
        evl_memory_run_out(1, 1);
    }
    return text;
}
