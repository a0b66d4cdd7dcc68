#include "commands/show_gears.h"

#include "base/memory.h"

#include <stdlib.h>
#include <string.h>

enum { MOST_COLUMNS = 4, COLUMN_WIDTH = 16 };

static const double MILLIMETRES_PER_METRE = 1000.0;
static const double DEGREES_PER_RADIAN = 57.295779513082320877;

/** One gear or mesh. */
typedef struct {
    const char *name;
    int n;
    model_quantity rows[MODEL_MOST_ROWS];
} column;

static double in_usual_unit(const model_quantity *quantity)
{
    const double factor = quantity->is_angle                  ? DEGREES_PER_RADIAN
                          : strcmp(quantity->units, "m") == 0 ? MILLIMETRES_PER_METRE
                                                              : 1.0;
    return quantity->value[0] * factor;
}

static const char *usual_unit(const model_quantity *quantity)
{
    return quantity->is_angle ? "deg" : strcmp(quantity->units, "m") == 0 ? "mm" : "";
}

/** Up to MOST_COLUMNS columns beside each other; all have the same rows. */
static void print_columns(FILE *stream, int n, const column *columns)
{
    int name_width = 0;
    for (int i = 0; i < columns[0].n; i++) {
        const int length = (int)strlen(columns[0].rows[i].long_name);
        name_width = length > name_width ? length : name_width;
    }
    fprintf(stream, "  %-*s  %-9s  %-3s", name_width, "", "", "");
    for (int k = 0; k < n; k++) {
        fprintf(stream, "  %*s", COLUMN_WIDTH, columns[k].name);
    }
    fputc('\n', stream);
    for (int i = 0; i < columns[0].n; i++) {
        const model_quantity *first = &columns[0].rows[i];
        fprintf(stream, "  %-*s  %-9s  %-3s", name_width, first->long_name, first->symbol, usual_unit(first));
        for (int k = 0; k < n; k++) {
            fprintf(stream, "  %*.10g", COLUMN_WIDTH, in_usual_unit(&columns[k].rows[i]));
        }
        fputc('\n', stream);
    }
}

/** The columns that have rows, MOST_COLUMNS at a time. */
static void print_table(FILE *stream, const char *title, int n, const column *columns)
{
    column shown[MOST_COLUMNS];
    int n_shown = 0;
    for (int i = 0; i < n; i++) {
        if (columns[i].n > 0) {
            shown[n_shown++] = columns[i];
        }
        if (n_shown == MOST_COLUMNS || (i == n - 1 && n_shown > 0)) {
            fprintf(stream, "\n%s\n", title);
            print_columns(stream, n_shown, shown);
            n_shown = 0;
        }
    }
}

void show_gears(FILE *stream, const description *description, const model *model)
{
    const int n_wheels = description->n_wheels, n_meshes = description->n_meshes;
    OWNED column *columns = xcalloc((size_t)(n_wheels > n_meshes ? n_wheels : n_meshes), sizeof *columns);
    for (int i = 0; i < n_wheels; i++) {
        columns[i].name = description->wheels[i];
        columns[i].n = model_gear(model, i, columns[i].rows);
    }
    print_table(stream, "Gears (ISO 21771)", n_wheels, columns);
    for (int i = 0; i < n_meshes; i++) {
        columns[i].name = description->meshes[i];
        columns[i].n = model_gear_mesh(model, i, columns[i].rows);
    }
    print_table(stream, "Gears in mesh (ISO 21771); 1 is the driving one", n_meshes, columns);
}
