/** Data sheet of a mesh: one table of rows in four formats. */
#pragma once

#include "simulate/case_plan.h"

#include <stdio.h>

typedef struct {
    const char *title, *path; /**< of the case */
    int mesh;
    const char *name, *wheels[2]; /**< of the mesh, and of its driving and driven wheel */
    int n;
    evl_sheet_row *rows; /**< [n] */
    evl_mesh_picture picture;
    int n_points[2], teeth[2]; /**< of the outlines; 0 points without a basic rack */
    double *outlines[2];       /**< x, y of the points [m] */
} datasheet;

/** Compute the data sheet of a mesh; free it afterwards. */
void datasheet_make(datasheet *sheet, const case_plan *plan, int mesh);
void datasheet_free(datasheet *sheet);

/** Values of a row in engineering units. */
typedef struct {
    const char *unit;   /**< in ASCII; "" of a dimensionless number */
    char values[2][32]; /**< "-" for a value that does not exist */
    int note;           /**< number of its footnote, from 1; 0: none */
} datasheet_cells;

/** Format a row. */
datasheet_cells datasheet_format(const datasheet *sheet, int row);
/** Whether a row begins a section. */
bool datasheet_is_first(const datasheet *sheet, int row);
/** Text of a footnote, from 1; NULL behind the last one. */
const char *datasheet_note(const datasheet *sheet, int note);

/** The formats. JSON has SI units and radians, the others engineering units. */
void datasheet_write_text(FILE *stream, const datasheet *sheet);
void datasheet_write_markdown(FILE *stream, const datasheet *sheet);
void datasheet_write_json(FILE *stream, const datasheet *sheet);
void datasheet_write_html(FILE *stream, const datasheet *sheet);
/** The HTML as an element of another page, with its style. */
void datasheet_write_section(FILE *stream, const datasheet *sheet);
