#include "analyses/datasheet.h"
#include "base/memory.h"
#include "case/unit_spelling.h"

#include <math.h>
#include <string.h>

#include <evolvent_version.h>

/* ---- text ---- */

/** Write text with the characters escaped that HTML would interpret. */
static void write_escaped(FILE *stream, const char *text, size_t n)
{
    for (size_t i = 0; i < n && text[i] != '\0'; i++) {
        switch (text[i]) {
        case '&':
            fputs("&amp;", stream);
            break;
        case '<':
            fputs("&lt;", stream);
            break;
        case '>':
            fputs("&gt;", stream);
            break;
        case '"':
            fputs("&quot;", stream);
            break;
        default:
            fputc(text[i], stream);
        }
    }
}

/** Write part of a symbol with its Greek letters. */
static void write_greek(FILE *stream, const char *text, size_t n)
{
    static const char *const letters[][2] = {{"alpha", "&alpha;"}, {"beta", "&beta;"}, {"gamma", "&gamma;"},
                                             {"eps", "&epsilon;"}, {"rho", "&rho;"},   {"zeta", "&zeta;"},
                                             {"sigma", "&sigma;"}};
    for (size_t i = 0; i < n;) {
        size_t k = 0, length = 0;
        while (k < sizeof letters / sizeof *letters && length == 0) {
            length = strlen(letters[k][0]);
            if (i + length > n || strncmp(text + i, letters[k][0], length) != 0) {
                length = 0;
                k++;
            }
        }
        if (length > 0) {
            fputs(letters[k][1], stream);
        } else {
            length = 1;
            write_escaped(stream, text + i, 1);
        }
        i += length;
    }
}

/** Write a symbol such as s_an/m_n: what follows an underscore is a subscript, an asterisk ends it. */
static void write_symbol(FILE *stream, const char *symbol)
{
    while (*symbol != '\0') {
        const size_t base = strcspn(symbol, "_");
        fputs("<i>", stream);
        write_greek(stream, symbol, base);
        fputs("</i>", stream);
        symbol += base;
        if (*symbol == '_') {
            const size_t n = strcspn(++symbol, "/*");
            fputs("<sub>", stream);
            write_greek(stream, symbol, n);
            fputs("</sub>", stream);
            symbol += n;
        }
    }
}

/* ---- drawing ---- */

/* Lengths of the drawing, in hundredths of a pitch on the working pitch circles. */
enum { HALF_WIDTH = 260, HALF_HEIGHT = 128, RIM = 34, LETTERS = 10 };

/** A drawing: factor from metres to its unit, y downwards. */
typedef struct {
    FILE *stream;
    const datasheet *sheet;
    double scale;
} drawing;

static void write_point(const drawing *d, char command, double x, double y)
{
    fprintf(d->stream, "%c%.2f %.2f", command, x * d->scale, -y * d->scale);
}

/** Whether one gear is internal: both centres are on one side of the pitch point. */
static bool is_internal(const evl_mesh_picture *picture)
{
    return picture->centre[0] * picture->centre[1] > 0;
}

static bool is_ring(const evl_mesh_picture *picture, int wheel)
{
    return is_internal(picture) && picture->pitch_radius[wheel] > picture->pitch_radius[1 - wheel];
}

/** Teeth of a gear on a part of its rim. */
static void draw_teeth(const drawing *d, int wheel)
{
    const evl_mesh_picture *picture = &d->sheet->picture;
    const double *points = d->sheet->outlines[wheel], centre = picture->centre[wheel];
    const int n = d->sheet->n_points[wheel];
    if (n == 0) {
        return;
    }
    fprintf(d->stream, "<path class=\"gear%d\" d=\"", wheel + 1);
    for (int i = 0; i < n; i++) {
        write_point(d, i == 0 ? 'M' : 'L', points[2 * i], points[2 * i + 1]);
    }
    const double into = is_ring(picture, wheel) ? 1.0 : -1.0; /* from the root circle into the body */
    const double rim = picture->root_radius[wheel] + into * RIM / d->scale;
    if (rim > 0.0) { /* back to the start at the inner radius, or the outer one of a ring, clockwise */
        const double *first = points, *last = points + 2 * (n - 1);
        const double root = hypot(last[0], last[1] - centre);
        write_point(d, 'L', last[0] * rim / root, centre + (last[1] - centre) * rim / root);
        fprintf(d->stream, "A%.2f %.2f 0 0 1 ", rim * d->scale, rim * d->scale);
        fprintf(d->stream, "%.2f %.2f", first[0] * rim / root * d->scale,
                -(centre + (first[1] - centre) * rim / root) * d->scale);
    }
    fputs("Z\"/>\n", d->stream);
}

/** A circle of a gear. */
static void draw_circle(const drawing *d, int wheel, const char *kind, double radius)
{
    fprintf(d->stream, "<circle class=\"%s\" cx=\"0\" cy=\"%.2f\" r=\"%.2f\"/>\n", kind,
            -d->sheet->picture.centre[wheel] * d->scale, radius * d->scale);
}

/** Labels of the circles of a gear, on the left for the driving gear and on the right for the driven one. Labels of
 *  close circles are moved apart, those of base and tip circle away from that of the pitch circle. */
static void draw_labels(const drawing *d, int wheel)
{
    static const char letters[] = {'b', 'w', 'a'};
    const evl_mesh_picture *picture = &d->sheet->picture;
    const double radii[] = {picture->base_radius[wheel], picture->pitch_radius[wheel], picture->tip_radius[wheel]};
    const double side = wheel == 0 ? -1.0 : 1.0, x = 0.62 * HALF_WIDTH / d->scale;
    const double down = picture->centre[wheel] > 0 ? 1.0 : -1.0; /* from the axle to the pitch point */
    double heights[3];                                           /* above the axle, towards the other gear */
    for (int i = 0; i < 3; i++) {
        heights[i] = sqrt(fmax(radii[i] * radii[i] - x * x, 0.0)) * d->scale;
    }
    if (is_ring(picture, wheel)) { /* the tip circle lies inside the pitch circle */
        heights[2] = fmin(heights[2], heights[1] - LETTERS);
        heights[0] = fmin(heights[0], heights[2] - LETTERS);
    } else {
        heights[0] = fmin(heights[0], heights[1] - LETTERS);
        heights[2] = fmax(heights[2], heights[1] + LETTERS);
    }
    for (int i = 0; i < 3; i++) {
        const double y = -picture->centre[wheel] * d->scale + down * heights[i];
        if (radii[i] > x && fabs(y) < HALF_HEIGHT - LETTERS) {
            fprintf(d->stream,
                    "<text x=\"%.2f\" y=\"%.2f\"><tspan class=\"i\">d</tspan><tspan dy=\"2\" class=\"s\">%c%d"
                    "</tspan></text>\n",
                    side * x * d->scale, y - 1.5, letters[i], wheel + 1);
        }
    }
}

/** Line of action with its points. */
static void draw_line(const drawing *d)
{
    static const char *const names[] = {"T1", "A", "B", "C", "D", "E", "T2"};
    const double (*points)[2] = d->sheet->picture.points;
    const double away = d->sheet->picture.sigma * 1.0;
    fputs("<path class=\"line\" d=\"", d->stream);
    write_point(d, 'M', points[0][0], points[0][1]);
    write_point(d, 'L', points[6][0], points[6][1]);
    if (is_internal(&d->sheet->picture)) { /* the path of contact lies beyond T1 or T2 */
        write_point(d, 'M', points[0][0], points[0][1]);
        write_point(d, 'L', points[5][0], points[5][1]);
    }
    fputs("\"/>\n<path class=\"contact\" d=\"", d->stream);
    write_point(d, 'M', points[1][0], points[1][1]);
    write_point(d, 'L', points[5][0], points[5][1]);
    fputs("\"/>\n", d->stream);
    for (int i = 0; i < 7; i++) {
        const double x = points[i][0] * d->scale, y = -points[i][1] * d->scale;
        if (isnan(x) || fabs(x) > HALF_WIDTH - LETTERS || fabs(y) > HALF_HEIGHT - LETTERS) {
            continue;
        }
        const bool is_end = i == 0 || i == 6, is_above = i != 2 && i != 4; /* neighbours on different sides */
        const double dx = is_end ? (i == 0 ? -away : away) * 9.0 : (is_above ? -away : away) * 4.0;
        const double dy = is_end ? 3.0 : is_above ? -4.5 : 11.0;
        fprintf(d->stream, "<circle class=\"point\" cx=\"%.2f\" cy=\"%.2f\" r=\"1.6\"/>\n", x, y);
        fprintf(d->stream, "<text class=\"name\" x=\"%.2f\" y=\"%.2f\">%.1s%s%s%s</text>\n", x + dx, y + dy, names[i],
                names[i][1] == '\0' ? "" : "<tspan dy=\"2\" class=\"s\">", names[i] + 1,
                names[i][1] == '\0' ? "" : "</tspan>");
    }
}

/** Name of a gear in a corner, with the direction in which its teeth move past the pitch point. */
static void draw_name(const drawing *d, int wheel)
{
    const bool is_right = d->sheet->picture.sigma > 0;
    const double y = wheel == 0 ? HALF_HEIGHT - 6.0 : -HALF_HEIGHT + 12.0;
    fprintf(d->stream, "<text class=\"gear\" x=\"%d\" y=\"%.1f\">%s %s, ", -HALF_WIDTH + 6, y,
            is_right ? "&#8594;" : "&#8592;", wheel == 0 ? "driving" : "driven");
    write_escaped(d->stream, d->sheet->wheels[wheel], strlen(d->sheet->wheels[wheel]));
    fputs("</text>\n", d->stream);
}

static void draw(FILE *stream, const datasheet *sheet)
{
    const evl_mesh_picture *picture = &sheet->picture;
    const double pi = acos(-1.0);
    const drawing d = {stream, sheet, 100.0 * picture->teeth[0] / (2 * pi * picture->pitch_radius[0])};
    fprintf(stream,
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"%d %d %d %d\" role=\"img\" aria-label=\"Teeth in "
            "mesh\">\n",
            -HALF_WIDTH, -HALF_HEIGHT, 2 * HALF_WIDTH, 2 * HALF_HEIGHT);
    for (int i = 0; i < 2; i++) {
        draw_teeth(&d, i);
    }
    for (int i = 0; i < 2; i++) {
        draw_circle(&d, i, "base", picture->base_radius[i]);
        draw_circle(&d, i, "pitch", picture->pitch_radius[i]);
        draw_circle(&d, i, "tip", picture->tip_radius[i]);
        draw_labels(&d, i);
    }
    draw_line(&d);
    for (int i = 0; i < 2; i++) {
        draw_name(&d, i);
    }
    fputs("</svg>\n", stream);
}

/* ---- page ---- */

static const char style[] =
    "@page{size:A4;margin:8mm 9mm}"
    ".datasheet{font:8pt/1.2 'Liberation Sans',Arial,Helvetica,'DejaVu Sans Condensed',sans-serif;color:#111;"
    "max-width:192mm}"
    ".datasheet h1,.datasheet h3{font-size:14pt;margin:0}.datasheet header p{margin:1mm 0 2mm}"
    ".datasheet svg{display:block;width:100%;border:.2mm solid #888;background:#fff;box-sizing:border-box}"
    ".datasheet svg text{font-size:10px;paint-order:stroke;stroke:#fff;stroke-width:2.4px;text-anchor:middle}"
    ".datasheet svg .gear{text-anchor:start}.datasheet svg .s{font-size:7px}.datasheet svg .i{font-style:italic}"
    ".datasheet svg .name{font-weight:bold}"
    ".datasheet .gear1{fill:#dce7f3;stroke:#1f4e79;stroke-width:1.1}"
    ".datasheet .gear2{fill:#f5e6d8;stroke:#8a3b12;stroke-width:1.1}"
    ".datasheet .base{fill:none;stroke:#555;stroke-width:.6;stroke-dasharray:7 2 1.5 2}"
    ".datasheet .pitch{fill:none;stroke:#333;stroke-width:.6;stroke-dasharray:5 3}"
    ".datasheet .tip{fill:none;stroke:#999;stroke-width:.45}"
    ".datasheet .line{fill:none;stroke:#a00;stroke-width:.7}.datasheet .contact{fill:none;stroke:#a00;stroke-width:2}"
    ".datasheet .point{fill:#a00}.datasheet .rows{columns:2;column-gap:5mm;margin-top:3mm}"
    ".datasheet table{border-collapse:collapse;table-layout:fixed;width:100%;margin:0 0 2mm;font-size:inherit;"
    "break-inside:avoid}"
    ".datasheet .t{width:40%}.datasheet .y{width:9%}.datasheet .u{width:12%}.datasheet .n{width:19.5%}"
    ".datasheet th,.datasheet td{padding:.15mm .6mm;border:0;text-align:left;vertical-align:baseline;min-width:0;"
    "font-weight:normal;overflow-wrap:anywhere}"
    ".datasheet thead th{border-bottom:.25mm solid #333;font-weight:bold}"
    ".datasheet tbody tr:nth-child(even){background:#f3f3f3}"
    ".datasheet td{white-space:nowrap}.datasheet .v{text-align:right;font-variant-numeric:tabular-nums}"
    ".datasheet sub,.datasheet sup{font-size:75%;line-height:0}"
    ".datasheet ol{margin:1mm 0 0;padding-left:5mm;font-size:7.2pt}"
    "@media print{.datasheet{max-width:none;font-size:6.7pt;line-height:1.1}.datasheet svg{height:64mm}"
    ".datasheet ol{font-size:6pt}.datasheet .rows{margin-top:2mm}.datasheet table{margin-bottom:1.2mm}"
    ".datasheet *{print-color-adjust:exact;-webkit-print-color-adjust:exact}}";

/** Style of the page that is the sheet. */
static const char page_style[] = "body{max-width:192mm;margin:6mm auto}@media print{body{margin:0;max-width:none}}";

static void write_row(FILE *stream, const datasheet *sheet, int i)
{
    const datasheet_cells cells = datasheet_format(sheet, i);
    const evl_sheet_row *row = &sheet->rows[i];
    char unit[UNIT_SPELLING_LENGTH];
    unit_typeset(cells.unit, unit);
    fprintf(stream, "<tr data-key=\"%s\"><th scope=\"row\">%s", row->key, row->text);
    if (cells.note > 0) {
        fprintf(stream, "<sup>%d</sup>", cells.note);
    }
    fputs("</th><td>", stream);
    write_symbol(stream, row->symbol);
    fprintf(stream, "</td><td>%s</td>", unit);
    if (row->n == 2) {
        fprintf(stream, "<td class=\"v\">%s</td><td class=\"v\">%s</td>", cells.values[0], cells.values[1]);
    } else {
        fprintf(stream, "<td class=\"v\" colspan=\"2\">%s</td>", cells.values[0]);
    }
    fputs("</tr>\n", stream);
}

static void write_table(FILE *stream, const datasheet *sheet, int first)
{
    fprintf(stream,
            "<table><colgroup><col class=\"t\"><col class=\"y\"><col class=\"u\"><col class=\"n\"><col "
            "class=\"n\"></colgroup>"
            "<thead><tr><th colspan=\"3\">%s</th>",
            sheet->rows[first].section);
    for (int k = 0; k < 2; k++) {
        fputs("<th class=\"v\">", stream);
        if (sheet->rows[first].n == 2) {
            write_escaped(stream, sheet->wheels[k], strlen(sheet->wheels[k]));
        }
        fputs("</th>", stream);
    }
    fputs("</tr></thead><tbody>\n", stream);
    for (int i = first; i < sheet->n && (i == first || !datasheet_is_first(sheet, i)); i++) {
        write_row(stream, sheet, i);
    }
    fputs("</tbody></table>\n", stream);
}

/** Write the sheet. @param heading  element of its title: "h1", or "h3" below the headings of another page */
static void write_sheet(FILE *stream, const datasheet *sheet, const char *heading)
{
    const char *title = sheet->title, *path = sheet->path;
    fprintf(stream, "<section class=\"datasheet\"><style>%s</style>\n<header><%s>Data sheet of mesh ", style, heading);
    write_escaped(stream, sheet->name, strlen(sheet->name));
    fprintf(stream, "</%s><p>", heading);
    write_escaped(stream, title, strlen(title));
    fputs(title[0] == '\0' ? "" : "; ", stream);
    fputs("case ", stream);
    write_escaped(stream, path, strlen(path));
    fprintf(stream, ", evolvent %s</p></header>\n", EVOLVENT_VERSION);
    draw(stream, sheet);
    fputs("<div class=\"rows\">\n", stream);
    for (int i = 0; i < sheet->n; i++) {
        if (datasheet_is_first(sheet, i)) {
            write_table(stream, sheet, i);
        }
    }
    fputs("</div>\n<ol>\n", stream);
    const char *note = NULL;
    for (int k = 1; (note = datasheet_note(sheet, k)) != NULL; k++) {
        fputs("<li>", stream);
        write_escaped(stream, note, strlen(note));
        fputs("</li>\n", stream);
    }
    fputs("</ol>\n</section>\n", stream);
}

void datasheet_write_section(FILE *stream, const datasheet *sheet)
{
    write_sheet(stream, sheet, "h3");
}

void datasheet_write_html(FILE *stream, const datasheet *sheet)
{
    fputs("<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>Data sheet of mesh ", stream);
    write_escaped(stream, sheet->name, strlen(sheet->name));
    fprintf(stream, "</title><style>%s</style></head><body>\n", page_style);
    write_sheet(stream, sheet, "h1");
    fputs("</body></html>\n", stream);
}
