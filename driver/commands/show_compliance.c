#include "commands/show_compliance.h"

#include <string.h>

/** A value in the unit in which engineers read it. */
static double in_usual_unit(const model_quantity *row, const char **unit)
{
    static const struct {
        const char *units, *usual;
        double factor;
    } table[] = {{"1/Pa", "um mm/N", 1e9}, {"Pa", "N/(mm um)", 1e-9}, {"N/m", "N/mm", 1e-3}};
    for (size_t i = 0; i < sizeof table / sizeof *table; i++) {
        if (strcmp(row->units, table[i].units) == 0) {
            *unit = table[i].usual;
            return row->value[0] * table[i].factor;
        }
    }
    *unit = row->units;
    return row->value[0];
}

void show_compliance(FILE *stream, const description *description, const model *model)
{
    model_quantity rows[MODEL_MOST_ROWS];
    for (int i = 0; i < description->n_meshes; i++) {
        const int n = model_mesh_stiffness(model, i, rows);
        if (n > 0) {
            fprintf(stream, "\nCompliance of the wheels in mesh %s, beside that of the contact\n",
                    description->meshes[i]);
        }
        for (int k = 0; k < n; k++) {
            const char *unit = NULL;
            const double value = in_usual_unit(&rows[k], &unit);
            fprintf(stream, "  %-52s %-4s %12.6g %s\n", rows[k].long_name, rows[k].symbol, value, unit);
        }
    }
}

void write_compliance(json_writer *writer, const description *description, const model *model)
{
    model_quantity rows[MODEL_MOST_ROWS];
    json_open(writer, "compliance", '{');
    for (int i = 0; i < description->n_meshes; i++) {
        const int n = model_mesh_stiffness(model, i, rows);
        if (n == 0) {
            continue;
        }
        json_open(writer, description->meshes[i], '{');
        for (int k = 0; k < n; k++) {
            json_number(writer, rows[k].name, rows[k].value[0]);
        }
        json_close(writer, '}');
    }
    json_close(writer, '}');
}
