#include "analyses/show_geometry.h"
#include "analyses/show_json.h"
#include "base/json.h"
#include "base/memory.h"
#include "base/number.h"
#include "case/case_schema.h"
#include "case/unit.h"
#include "commands/cached_case.h"
#include "commands/command.h"
#include "simulate/case_start.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct {
    option_values set, convert;
    bool json, parameters, laws, keys, schema, units;
} show_options;

/* ---- text ---- */

/** Append the speeds of a line in the other unit: in rad/s if they are in rpm, and in rpm if they are in rad/s. */
static void print_speeds(FILE *stream, const char *line, size_t n)
{
    static const char *const names[] = {" rpm", " rad/s"}, *const others[] = {"rad/s", "rpm"};
    const double rpm = unit_of_name("rad/s", "rpm").factor, factors[] = {1 / rpm, rpm};
    const char *before = "   # ";
    for (size_t i = 0; i < n; i++) {
        for (size_t k = 0; k < 2; k++) {
            const size_t length = strlen(names[k]);
            if (strncmp(line + i, names[k], length) != 0 || i + length > n) {
                continue;
            }
            size_t first = i;
            while (first > 0 && strchr("+-.0123456789e", line[first - 1]) != NULL) {
                first--;
            }
            if (first < i) {
                fprintf(stream, "%s%.6g %s", before, strtod(line + first, NULL) * factors[k], others[k]);
                before = ", ";
            }
        }
    }
}

static void print_indented(FILE *stream, const char *text)
{
    for (const char *line = text; *line != '\0';) {
        const size_t n = strcspn(line, "\n");
        fprintf(stream, "  %.*s", (int)n, line);
        if (strncmp(line, "title:", strlen("title:")) != 0) {
            print_speeds(stream, line, n);
        }
        fputc('\n', stream);
        line += n + (line[n] == '\n' ? 1 : 0);
    }
}

/** Print the effect of an accuracy specified in the case. */
static void show_accuracy(FILE *stream, const simulation_description *simulation)
{
    if (simulation->accuracy > 0) {
        fprintf(stream, "\nAccuracy\n  %g of the largest penetration: %s with a tolerance of %g\n",
                simulation->accuracy, integrator_name(simulation), simulation->tolerance);
    }
}

/** Print the available geometry of a refused case. */
static void show_sketch(FILE *stream, const description *description)
{
    model *sketch = model_sketch(description);
    if (sketch != NULL) {
        show_geometry(stream, description, sketch);
    }
    model_delete(&sketch);
}

/** Print the resolved case, the derived geometry of every wheel and mesh, and the warnings. Of a case without a model
 *  only the case and the geometry of its gears. */
static void show_text(FILE *stream, const case_plan *plan)
{
    fprintf(stream, "Case %s, with all defaults\n\n", plan->path);
    CLEANUP_FREE char *text = case_text_for_reading(plan->file, model_schema());
    print_indented(stream, text);
    if (plan->model == NULL) {
        show_sketch(stream, plan->description);
    } else {
        show_accuracy(stream, &plan->description->simulation);
        show_geometry(stream, plan->description, plan->model);
        CLEANUP_FREE char *note = stiffness_note(plan->description, plan->model);
        if (note[0] != '\0') {
            fprintf(stream, "\nNote\n  %s\n", note);
        }
    }
    CLEANUP_FREE char *warnings = case_plan_warnings(plan, NULL, "\n  ");
    if (warnings[0] != '\0') {
        fprintf(stream, "\nWarnings\n  %s\n", warnings);
    }
}

/* ---- laws and keys ---- */

static void print_row(FILE *stream, const evl_row *row)
{
    char range_text[128], plausible[128];
    row_range_text(row, range_text);
    row_plausible_text(row, plausible);
    const char *value = row->default_text[0] == '\0' ? "from the mesh" : row->default_text;
    fprintf(stream, "      %s%s%s%s: %s\n", row->key, row->unit[0] == '\0' ? "" : " [", row->unit,
            row->unit[0] == '\0' ? "" : "]", row->text);
    fprintf(stream, "        %s%s%s%s%s%s\n", row->required ? "required" : "default ", row->required ? "" : value,
            range_text[0] == '\0' ? "" : ", ", range_text, plausible[0] == '\0' ? "" : "; plausible: ", plausible);
}

static void show_laws(FILE *stream)
{
    static const char *const families[] = {"contact", "damping", "friction"};
    for (size_t family = 0; family < sizeof families / sizeof *families; family++) {
        int n_laws = 0, n_rows = 0;
        CLEANUP_FREE evl_kind *laws = model_kinds(families[family], &n_laws);
        const evl_row *rows = schema_block(model_schema(), families[family], &n_rows);
        fprintf(stream, "%s%s:\n", family == 0 ? "" : "\n", families[family]);
        for (int i = 0; i < n_laws; i++) {
            fprintf(stream, "  {law: %s}  %s\n", laws[i].name, laws[i].text);
            if (laws[i].source[0] != '\0') {
                fprintf(stream, "      source: %s\n", laws[i].source);
            }
            for (int k = 1; k < n_rows; k++) {
                if (row_in_variant(&rows[k], laws[i].name)) {
                    print_row(stream, &rows[k]);
                }
            }
        }
    }
}

/* ---- parameters ---- */

static void print_parameter(FILE *stream, const evl_parameter *parameter, const double *numbers)
{
    char number[NUMBER_TEXT_LENGTH];
    fprintf(stream, "%s = %s", parameter->path, parameter->n == 1 ? "" : "[");
    for (int i = 0; i < parameter->n; i++) {
        number_write(number, numbers[i]);
        fprintf(stream, "%s%s", i == 0 ? "" : ", ", number);
    }
    fprintf(stream, "%s%s%s\n", parameter->n == 1 ? "" : "]", parameter->unit[0] == '\0' ? "" : " ", parameter->unit);
}

static void print_parameters(FILE *stream, const model *model)
{
    evl_parameter parameter;
    double *numbers = NULL;
    for (int i = 0; (numbers = model_parameter_at(model, i, &parameter)) != NULL; i++) {
        print_parameter(stream, &parameter, numbers);
        free(numbers);
    }
}

/* ---- units ---- */

/** Print the numbers of values in the units of their keys, as a JSON list. */
static void show_converted(FILE *stream, const char *file, const option_values *options, evl_error *error)
{
    case_base *base = case_base_read(file, model_schema(), error);
    CLEANUP_FREE case_quantity *quantities = xcalloc((size_t)options->n, sizeof *quantities);
    bool good = base != NULL;
    for (int i = 0; i < options->n && good; i++) {
        good = case_base_convert(base, options->values[i], &quantities[i], error);
    }
    case_base_delete(&base);
    if (!good) {
        return;
    }
    json_writer writer = {.stream = stream};
    json_open(&writer, NULL, '[');
    for (int i = 0; i < options->n; i++) {
        json_open(&writer, NULL, '{');
        json_text(&writer, "option", options->values[i]);
        json_text(&writer, "unit", quantities[i].unit);
        json_number(&writer, "value", quantities[i].is_number ? quantities[i].value : NAN);
        json_text(&writer, "given", !quantities[i].is_number ? "text" : quantities[i].has_unit ? "quantity" : "number");
        json_close(&writer, '}');
    }
    json_close(&writer, ']');
}

/* ---- the command ---- */

static void show_plan(const case_plan *plan, const show_options *options, evl_error *error)
{
    if (options->parameters && plan->model != NULL) {
        (options->json ? show_parameters_json : print_parameters)(stdout, plan->model);
    } else if (options->json && !options->parameters) {
        show_json(stdout, plan, error);
    } else if (!options->parameters) {
        show_text(stdout, plan);
    }
}

static evl_exit show(const char *file, const void *given, evl_error *error)
{
    const show_options *options = given;
    if (options->laws) {
        show_laws(stdout);
    } else if (options->keys) {
        schema_print(stdout, model_schema());
    } else if (options->units) {
        unit_print(stdout);
    } else if (options->convert.n > 0) {
        show_converted(stdout, file, &options->convert, error);
    } else if (options->schema) {
        schema_write_json(stdout, model_schema());
    } else {
        case_plan plan = {0};
        (void)(cached_case(&plan, file, &options->set, options->parameters ? PLAN_ROOTS_OF_CASE : PLAN_ROOT_STRESS,
                           error) &&
               case_start_check(&plan, error));
        if (plan.file != NULL) {
            show_plan(&plan, options, error);
        }
        case_plan_free(&plan);
    }
    return error->code;
}

static const option_row rows[] = {
    OPTION_ROW_SET(show_options),
    OPTION_ROW_JSON(show_options),
    {OPTION_FLAG, 0, "--parameters", NULL, offsetof(show_options, parameters),
     "print instead the numbers of the case with their paths and units, as for --set"},
    {OPTION_ALONE, 0, "--laws", NULL, offsetof(show_options, laws),
     "print instead all laws of contact, damping and friction"},
    {OPTION_ALONE, 0, "--keys", NULL, offsetof(show_options, keys),
     "print instead all keys of a case file, as Markdown"},
    {OPTION_ALONE, 0, "--units", NULL, offsetof(show_options, units), "print instead the accepted units, as Markdown"},
    {OPTION_LIST, 0, "--convert", "PATH=VALUE", offsetof(show_options, convert),
     "print instead the value converted to the unit of its key, as JSON; may be repeated"},
    {OPTION_ALONE, 0, "--schema", NULL, offsetof(show_options, schema),
     "print instead a JSON Schema of all keys, for checks in editors"},
    OPTION_ROW_HELP,
};

const command show_command = {
    .name = "show",
    .synopsis = "CASE.yaml [--set PATH=VALUE]... [--json] [--parameters] | --convert PATH=VALUE... | --laws | --keys | "
                "--schema | --units",
    .summary = "print a case with its defaults and derived geometry",
    .text = "Prints the case with all defaults and its derived geometry, without integration. If the case is invalid,\n"
            "it prints the available part, then the error message of 'evolvent run', and returns the same exit code.\n"
            "\n"
            "Examples:\n"
            "  evolvent show examples/paper.yaml\n"
            "  evolvent show examples/paper.yaml --set wheels.gear.teeth=40 --json\n"
            "  evolvent show examples/paper.yaml --parameters\n"
            "  evolvent show --laws\n",
    .file = "case file",
    .size = sizeof(show_options),
    OPTION_ROWS(rows),
    .run = show,
};
