#include "commands/show_deviations.h"

#include "base/memory.h"

#include <stdlib.h>

enum { ERRORS_A_LINE = 10 };

static const double MILLIMETRES_PER_METRE = 1e3;
static const double MICROMETRES_PER_METRE = 1e6;
static const double DEGREES_PER_RADIAN = 57.295779513082320877;

/** The pitch errors of a wheel; NULL if it has none. The caller frees them. */
static double *pitch_errors_of(const model *model, int wheel)
{
    double *errors = xcalloc((size_t)model_teeth(model, wheel), sizeof *errors);
    if (!model_pitch_errors(model, wheel, errors)) {
        free(errors);
        errors = NULL;
    }
    return errors;
}

static void print_errors(FILE *stream, int n, const double *errors)
{
    fprintf(stream, "  pitch errors of teeth 0 to %d [um]", n - 1);
    for (int i = 0; i < n; i++) {
        fprintf(stream, "%s%8.3f", i % ERRORS_A_LINE == 0 ? "\n  " : "", errors[i] * MICROMETRES_PER_METRE);
    }
    fputc('\n', stream);
}

void show_deviations(FILE *stream, const description *description, const model *model)
{
    model_quantity rows[MODEL_MOST_ROWS];
    for (int i = 0; i < description->n_wheels; i++) {
        const int n = model_deviation(model, i, rows);
        if (n == 0) {
            continue;
        }
        fprintf(stream, "\nDeviations of the flanks of wheel %s\n", description->wheels[i]);
        for (int k = 0; k < n; k++) {
            const double factor = rows[k].is_angle ? DEGREES_PER_RADIAN : MILLIMETRES_PER_METRE;
            fprintf(stream, "  %-43s %-5s %16.10g %s\n", rows[k].long_name, rows[k].symbol, rows[k].value[0] * factor,
                    rows[k].is_angle ? "deg" : "mm");
        }
        double *errors = pitch_errors_of(model, i);
        if (errors != NULL) {
            print_errors(stream, model_teeth(model, i), errors);
        }
        free(errors);
    }
}

void write_deviations(json_writer *writer, const description *description, const model *model)
{
    model_quantity rows[MODEL_MOST_ROWS];
    json_open(writer, "deviations", '{');
    for (int i = 0; i < description->n_wheels; i++) {
        const int n = model_deviation(model, i, rows);
        if (n == 0) {
            continue;
        }
        json_open(writer, description->wheels[i], '{');
        for (int k = 0; k < n; k++) {
            json_number(writer, rows[k].name, rows[k].value[0]);
        }
        double *errors = pitch_errors_of(model, i);
        if (errors != NULL) {
            json_numbers(writer, "pitch_errors", model_teeth(model, i), errors);
        }
        free(errors);
        json_close(writer, '}');
    }
    json_close(writer, '}');
}
