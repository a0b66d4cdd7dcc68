#include "analyses/datasheet.h"

#include "base/memory.h"
#include "case/unit.h"

#include <math.h>
#include <string.h>

enum { MOST_TEETH = 9, DIGITS = 7 };

void datasheet_make(datasheet *sheet, const case_plan *plan, int mesh)
{
    const description *description = plan->description;
    *sheet =
        (datasheet){.title = description->title, .path = plan->path, .mesh = mesh, .name = description->meshes[mesh]};
    sheet->rows = model_datasheet(plan->model, mesh, &sheet->n);
    model_mesh_picture(plan->model, mesh, &sheet->picture);
    for (int i = 0; i < 2; i++) {
        const int odd = sheet->picture.teeth[i] - 1 + sheet->picture.teeth[i] % 2;
        sheet->wheels[i] = description->wheels[sheet->picture.wheel[i]];
        sheet->teeth[i] = odd < MOST_TEETH ? odd : MOST_TEETH;
        sheet->outlines[i] = model_mesh_outline(plan->model, mesh, i, sheet->teeth[i], &sheet->n_points[i]);
    }
}

void datasheet_free(datasheet *sheet)
{
    free(sheet->rows);
    free(sheet->outlines[0]);
    free(sheet->outlines[1]);
}

/** Unit of a row: stresses in MPa, stiffness per width and line load as in tables of tooth stiffness. */
static reading_unit unit_of(const evl_sheet_row *row, double largest)
{
    if (strcmp(row->unit, "Pa") == 0) {
        return unit_of_name("Pa", strstr(row->key, "stiffness") == NULL ? "MPa" : "N/(mm um)");
    }
    return strcmp(row->unit, "N/m") == 0 ? unit_of_name("N/m", "N/mm") : unit_for_reading(row->unit, largest);
}

/** Number of the first row with this note. */
static int first_with(const datasheet *sheet, const char *note)
{
    int i = 0;
    while (strcmp(sheet->rows[i].note, note) != 0) {
        i++;
    }
    return i;
}

datasheet_cells datasheet_format(const datasheet *sheet, int row)
{
    const evl_sheet_row *r = &sheet->rows[row];
    double largest = 0.0;
    for (int i = 0; i < r->n; i++) {
        largest = fmax(largest, fabs(r->value[i]));
    }
    const reading_unit unit = unit_of(r, largest);
    datasheet_cells cells = {.unit = unit.name};
    for (int i = 0; i < r->n; i++) {
        if (isnan(r->value[i])) {
            (void)snprintf(cells.values[i], sizeof cells.values[i], "-");
        } else {
            (void)snprintf(cells.values[i], sizeof cells.values[i], "%.*g", DIGITS, r->value[i] * unit.factor);
        }
    }
    if (r->note[0] != '\0') {
        const int last = first_with(sheet, r->note);
        for (int i = 0; i <= last; i++) {
            cells.note += sheet->rows[i].note[0] != '\0' && first_with(sheet, sheet->rows[i].note) == i ? 1 : 0;
        }
    }
    return cells;
}

bool datasheet_is_first(const datasheet *sheet, int row)
{
    return row == 0 || strcmp(sheet->rows[row].section, sheet->rows[row - 1].section) != 0;
}

const char *datasheet_note(const datasheet *sheet, int note)
{
    for (int i = 0; i < sheet->n; i++) {
        if (sheet->rows[i].note[0] != '\0' && first_with(sheet, sheet->rows[i].note) == i && --note == 0) {
            return sheet->rows[i].note;
        }
    }
    return NULL;
}
