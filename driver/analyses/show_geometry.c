#include "analyses/show_geometry.h"

#include "base/memory.h"
#include "base/words.h"
#include "case/unit.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_COLUMNS = 4, COLUMN_WIDTH = 16, ERRORS_A_LINE = 10 };

static const double MICROMETRES_PER_METRE = 1e6;

/** Quantities of a wheel or mesh. */
typedef struct {
    const char *name;
    int n;
    evl_output rows[EVL_MOST_QUANTITIES];
} column;

static column column_of(const model *model, evl_of of, int index, const char *name)
{
    column column = {.name = name};
    column.n = model_geometry(model, of, index, column.rows);
    return column;
}

/** Pitch deviations of a wheel, a new array; empty if it has none. */
static double *pitch_errors_of(const model *model, int wheel, int *n)
{
    *n = model_pitch_errors(model, wheel, 0, NULL);
    double *errors = xcalloc((size_t)*n, sizeof *errors);
    (void)model_pitch_errors(model, wheel, *n, errors);
    return errors;
}

/* ---- tables ---- */

/** Print one quantity per line; nothing if there are none. */
static void print_rows(FILE *stream, const char *title, const column *column)
{
    int name_width = 0, symbol_width = 0;
    if (column->n == 0) {
        return;
    }
    for (int i = 0; i < column->n; i++) {
        name_width = words_width(name_width, column->rows[i].long_name);
        symbol_width = words_width(symbol_width, column->rows[i].symbol);
    }
    fprintf(stream, "\n%s %s\n", title, column->name);
    for (int i = 0; i < column->n; i++) {
        const evl_output *row = &column->rows[i];
        fprintf(stream, "  %-*s  %-*s  ", name_width, row->long_name, symbol_width, row->symbol);
        const bool is_point = row->n == 2;
        const reading_unit unit =
            unit_for_reading(row->units, is_point ? fmax(fabs(row->value[0]), fabs(row->value[1])) : row->value[0]);
        if (isnan(row->value[0])) {
            fputs("-\n", stream);
            continue;
        }
        if (is_point) {
            fprintf(stream, "(%.10g, %.10g)", row->value[0] * unit.factor, row->value[1] * unit.factor);
        } else {
            fprintf(stream, "%.10g", row->value[0] * unit.factor);
        }
        fprintf(stream, "%s%s\n", unit.name[0] == '\0' ? "" : " ", unit.name);
    }
}

/** Unit of a row of a list: stiffness per face width and line load as in tables of tooth stiffness. */
static reading_unit unit_of(const evl_output *quantity)
{
    return strcmp(quantity->units, "Pa") == 0    ? unit_of_name("Pa", "N/(mm um)")
           : strcmp(quantity->units, "N/m") == 0 ? unit_of_name("N/m", "N/mm")
                                                 : unit_for_reading(quantity->units, quantity->value[0]);
}

/** Print one quantity per line. */
static void print_list(FILE *stream, const column *column, const int widths[3], int digits)
{
    for (int i = 0; i < column->n; i++) {
        const evl_output *row = &column->rows[i];
        const reading_unit unit = unit_of(row);
        fprintf(stream, "  %-*s %-*s %*.*g %s\n", widths[0], row->long_name, widths[1], row->symbol, widths[2], digits,
                row->value[0] * unit.factor, unit.name);
    }
}

/** The unit of a row of columns. */
static reading_unit unit_of_row(int row, int n, const column *columns)
{
    double largest = 0;
    for (int k = 0; k < n; k++) {
        largest = fmax(largest, fabs(columns[k].rows[row].value[0]));
    }
    return unit_for_reading(columns[0].rows[row].units, largest);
}

/** Print up to MOST_COLUMNS columns side by side; all have the same rows. */
static void print_columns(FILE *stream, int n, const column *columns)
{
    int name_width = 0;
    for (int i = 0; i < columns[0].n; i++) {
        name_width = words_width(name_width, columns[0].rows[i].long_name);
    }
    fprintf(stream, "  %-*s  %-9s  %-3s", name_width, "", "", "");
    for (int k = 0; k < n; k++) {
        fprintf(stream, "  %*s", COLUMN_WIDTH, columns[k].name);
    }
    fputc('\n', stream);
    for (int i = 0; i < columns[0].n; i++) {
        const evl_output *first = &columns[0].rows[i];
        const reading_unit unit = unit_of_row(i, n, columns);
        fprintf(stream, "  %-*s  %-9s  %-3s", name_width, first->long_name, first->symbol, unit.name);
        for (int k = 0; k < n; k++) {
            const double value = columns[k].rows[i].value[0];
            if (isnan(value)) {
                fprintf(stream, "  %*s", COLUMN_WIDTH, "-");
            } else {
                fprintf(stream, "  %*.10g", COLUMN_WIDTH, value * unit.factor);
            }
        }
        fputc('\n', stream);
    }
}

/** Print a table of the elements that have rows, MOST_COLUMNS at a time: nothing if the case has no gears with a basic
 *  rack. */
static void print_table(FILE *stream, const char *title, const model *model, evl_of of, int n, const char *const *names)
{
    column shown[MOST_COLUMNS];
    int n_shown = 0;
    for (int i = 0; i < n; i++) {
        shown[n_shown] = column_of(model, of, i, names[i]);
        n_shown += shown[n_shown].n > 0 ? 1 : 0;
        if (n_shown == MOST_COLUMNS || (i == n - 1 && n_shown > 0)) {
            fprintf(stream, "\n%s\n", title);
            print_columns(stream, n_shown, shown);
            n_shown = 0;
        }
    }
}

static void print_deviations(FILE *stream, const model *model, int wheel, const char *name)
{
    const column column = column_of(model, EVL_OF_DEVIATION, wheel, name);
    int n = 0;
    CLEANUP_FREE double *errors = pitch_errors_of(model, wheel, &n);
    if (column.n > 0) {
        fprintf(stream, "\nDeviations of the flanks of wheel %s\n", name);
    }
    print_list(stream, &column, (const int[]){43, 5, COLUMN_WIDTH}, 10);
    if (n > 0) {
        fprintf(stream, "  pitch errors of teeth 0 to %d [um]", n - 1);
    }
    for (int i = 0; i < n; i++) {
        fprintf(stream, "%s%8.3f%s", i % ERRORS_A_LINE == 0 ? "\n  " : "", errors[i] * MICROMETRES_PER_METRE,
                i == n - 1 ? "\n" : "");
    }
}

/** Print the compliance of the wheels of a mesh: nothing if both are rigid. */
static void print_compliance(FILE *stream, const model *model, int mesh, const char *name)
{
    const column column = column_of(model, EVL_OF_COMPLIANCE, mesh, name);
    if (column.n > 0) {
        fprintf(stream, "\nCompliance of the wheels in mesh %s, in addition to that of the contact\n", name);
    }
    print_list(stream, &column, (const int[]){52, 4, 12}, 6);
}

/* ---- root stress ---- */

enum { DRIVING, DRIVEN, N_SIDES };
static const char *const sides[] = {[DRIVING] = "driving", [DRIVEN] = "driven"};

/** Root stress of the wheels of a mesh that have it. @return their number */
static int root_stresses_of(const model *model, int mesh, column columns[N_SIDES])
{
    int n = 0;
    for (int side = 0; side < N_SIDES; side++) {
        columns[n] = column_of(model, EVL_OF_ROOT_STRESS, N_SIDES * mesh + side, sides[side]);
        n += columns[n].n > 0 ? 1 : 0;
    }
    return n;
}

/** Unit of a row of the root stress; one for all magnitudes. */
static reading_unit root_stress_unit(const evl_output *row)
{
    return strcmp(row->units, "Pa") == 0    ? unit_of_name("Pa", "MPa")
           : strcmp(row->units, "N/m") == 0 ? unit_of_name("N/m", "N/mm")
           : strcmp(row->units, "m") == 0   ? unit_of_name("m", "mm")
                                            : (reading_unit){"", 1};
}

static double value_named(const column *column, const char *name)
{
    int i = 0;
    while (strcmp(column->rows[i].name, name) != 0) {
        i++;
    }
    return column->rows[i].value[0];
}

/** Print why values of the root stress are missing, and its assumptions. */
static void print_root_stress_notes(FILE *stream, int n, const column *columns)
{
    const bool is_single = !isnan(value_named(&columns[0], "load_position"));
    if (!is_single) {
        fputs("  No values: at a contact ratio of 2 or more, no position has a single tooth pair.\n", stream);
    }
    for (int k = 0; k < n && is_single; k++) {
        if (isnan(value_named(&columns[k], "nominal_stress"))) {
            fprintf(stream,
                    "  No nominal stress of the %s wheel: q_s = %.4g is outside 1 to 8, or its fillet has no tangent "
                    "of 30 degrees.\n",
                    columns[k].name, value_named(&columns[k], "notch_parameter"));
        }
    }
    fputs("  Uniform stress over the face width (K_Fbeta = K_Hbeta = 1), no friction along the flank.\n", stream);
}

/** Print the root stress of the wheels of a mesh: nothing if no wheel has finite elements. */
static void print_root_stress(FILE *stream, const model *model, int mesh, const char *name)
{
    enum { DIGITS = 5, WIDTH = 10 };
    column columns[N_SIDES];
    const int n = root_stresses_of(model, mesh, columns);
    if (n == 0) {
        return;
    }
    fprintf(stream, "\nRoot stress in mesh %s: one pair at the outer point of single contact, nominal load\n  %-*s",
            name, 66, "");
    for (int k = 0; k < n; k++) {
        fprintf(stream, "  %*s", WIDTH, columns[k].name);
    }
    fputc('\n', stream);
    for (int i = 0; i < columns[0].n; i++) {
        const evl_output *row = &columns[0].rows[i];
        const reading_unit unit = root_stress_unit(row);
        fprintf(stream, "  %-51s %-9s %-4s", row->long_name, row->symbol, unit.name);
        for (int k = 0; k < n; k++) {
            const double value = columns[k].rows[i].value[0];
            if (isnan(value)) {
                fprintf(stream, "  %*s", WIDTH, "-");
            } else {
                fprintf(stream, "  %*.*g", WIDTH, DIGITS, value * unit.factor);
            }
        }
        fputc('\n', stream);
    }
    print_root_stress_notes(stream, n, columns);
}

void show_geometry(FILE *stream, const description *description, const model *model)
{
    for (int i = 0; i < description->n_wheels; i++) {
        const column column = column_of(model, EVL_OF_WHEEL, i, description->wheels[i]);
        print_rows(stream, "Wheel", &column);
    }
    for (int i = 0; i < description->n_meshes; i++) {
        const column column = column_of(model, EVL_OF_MESH, i, description->meshes[i]);
        print_rows(stream, "Mesh", &column);
    }
    print_table(stream, "Gears (ISO 21771)", model, EVL_OF_GEAR, description->n_wheels, description->wheels);
    print_table(stream, "Gears in mesh (ISO 21771); 1 is the driving gear", model, EVL_OF_GEAR_MESH,
                description->n_meshes, description->meshes);
    for (int i = 0; i < description->n_wheels; i++) {
        print_deviations(stream, model, i, description->wheels[i]);
    }
    for (int i = 0; i < description->n_meshes; i++) {
        print_compliance(stream, model, i, description->meshes[i]);
    }
    for (int i = 0; i < description->n_meshes; i++) {
        print_root_stress(stream, model, i, description->meshes[i]);
    }
}

char *stiffness_note(const description *description, const model *model)
{
    const char *first = NULL;
    int others = -1;
    for (int i = 0; i < description->n_meshes; i++) {
        if (model_quantity(model, EVL_OF_MESH, i, "gives_way") == 0) {
            first = first == NULL ? description->meshes[i] : first;
            others++;
        }
    }
    CLEANUP_FREE char *more = others > 0 ? xasprintf(" and %d more", others) : xstrdup("");
    return first == NULL
               ? xstrdup("")
               : xasprintf("mesh %s%s: only the contact is compliant, so natural frequencies are about 1.5 to 1.9 "
                           "times too high; add 'compliance: {}' to its wheels for compliant teeth and bodies",
                           first, more);
}

/* ---- JSON ---- */

static void write_rows(json_writer *writer, const column *column)
{
    for (int i = 0; i < column->n; i++) {
        const evl_output *row = &column->rows[i];
        if (row->n == 2) {
            json_numbers(writer, row->name, 2, row->value);
        } else {
            json_number(writer, row->name, row->value[0]);
        }
    }
}

/** Write the wheels or meshes, each with its data as a gear with a basic rack, if it is one. */
static void write_all(json_writer *writer, const char *key, const model *model, evl_of of, evl_of of_gear, int n,
                      const char *const *names)
{
    json_open(writer, key, '{');
    for (int i = 0; i < n; i++) {
        const column column = column_of(model, of, i, names[i]), gear = column_of(model, of_gear, i, names[i]);
        json_open(writer, names[i], '{');
        write_rows(writer, &column);
        if (gear.n > 0) {
            json_open(writer, "gear", '{');
            write_rows(writer, &gear);
            json_close(writer, '}');
        }
        json_close(writer, '}');
    }
    json_close(writer, '}');
}

/** Write the quantities of an element that has any, with its pitch deviations. */
static void write_one(json_writer *writer, const model *model, evl_of of, int index, const char *name)
{
    const column column = column_of(model, of, index, name);
    int n = 0;
    CLEANUP_FREE double *errors = of == EVL_OF_DEVIATION ? pitch_errors_of(model, index, &n) : NULL;
    if (column.n == 0) {
        return;
    }
    json_open(writer, name, '{');
    write_rows(writer, &column);
    if (n > 0) {
        json_numbers(writer, "pitch_errors", n, errors);
    }
    json_close(writer, '}');
}

/** Write the root stress of the wheels of a mesh that have it. */
static void write_root_stress(json_writer *writer, const model *model, int mesh, const char *name)
{
    column columns[N_SIDES];
    const int n = root_stresses_of(model, mesh, columns);
    if (n == 0) {
        return;
    }
    json_open(writer, name, '{');
    for (int k = 0; k < n; k++) {
        json_open(writer, columns[k].name, '{');
        write_rows(writer, &columns[k]);
        json_close(writer, '}');
    }
    json_close(writer, '}');
}

void write_geometry(json_writer *writer, const description *description, const model *model)
{
    write_all(writer, "wheels", model, EVL_OF_WHEEL, EVL_OF_GEAR, description->n_wheels, description->wheels);
    write_all(writer, "meshes", model, EVL_OF_MESH, EVL_OF_GEAR_MESH, description->n_meshes, description->meshes);
    json_open(writer, "deviations", '{');
    for (int i = 0; i < description->n_wheels; i++) {
        write_one(writer, model, EVL_OF_DEVIATION, i, description->wheels[i]);
    }
    json_close(writer, '}');
    json_open(writer, "compliance", '{');
    for (int i = 0; i < description->n_meshes; i++) {
        write_one(writer, model, EVL_OF_COMPLIANCE, i, description->meshes[i]);
    }
    json_close(writer, '}');
    json_open(writer, "root_stress", '{');
    for (int i = 0; i < description->n_meshes; i++) {
        write_root_stress(writer, model, i, description->meshes[i]);
    }
    json_close(writer, '}');
}
