#include "analyses/datasheet.h"
#include "base/json.h"
#include "base/memory.h"
#include "base/utf8.h"
#include "base/words.h"
#include "case/unit_spelling.h"

#include <string.h>

#include <evolvent_version.h>

enum { COLUMN_WIDTH = 14 };

/* ---- text ---- */

static int width_of(const datasheet *sheet, size_t offset)
{
    int width = 0;
    for (int i = 0; i < sheet->n; i++) {
        width = words_width(width, (const char *)&sheet->rows[i] + offset);
    }
    return width;
}

/** Print the name of a wheel at the right end of a column. */
static void print_right(FILE *stream, const char *name, int width)
{
    int columns = 0;
    for (const char *c = name; *c != '\0'; columns++) {
        const int length = utf8_length(c);
        c += length > 1 ? length : 1;
    }
    fprintf(stream, "%*s%s", columns < width ? width - columns : 0, "", name);
}

void datasheet_write_text(FILE *stream, const datasheet *sheet)
{
    const int text = width_of(sheet, offsetof(evl_sheet_row, text)),
              symbol = width_of(sheet, offsetof(evl_sheet_row, symbol));
    fprintf(stream, "Data sheet of mesh %s\n", sheet->name);
    fprintf(stream, "%s%scase %s, evolvent %s\n", sheet->title, sheet->title[0] == '\0' ? "" : "; ", sheet->path,
            EVOLVENT_VERSION);
    for (int i = 0; i < sheet->n; i++) {
        const datasheet_cells cells = datasheet_format(sheet, i);
        const evl_sheet_row *row = &sheet->rows[i];
        if (datasheet_is_first(sheet, i)) {
            fprintf(stream, "\n%s", row->section);
            if (row->n == 2) {
                const int width = text + 2 + symbol + 2 + 9 + 2 + 2 - (int)strlen(row->section);
                print_right(stream, sheet->wheels[0], width + COLUMN_WIDTH);
                fputs("  ", stream);
                print_right(stream, sheet->wheels[1], COLUMN_WIDTH);
            }
            fputc('\n', stream);
        }
        fprintf(stream, "  %-*s  %-*s  %9s  %*s", text, row->text, symbol, row->symbol, cells.unit, COLUMN_WIDTH,
                cells.values[0]);
        if (row->n == 2) {
            fprintf(stream, "  %*s", COLUMN_WIDTH, cells.values[1]);
        }
        if (cells.note > 0) {
            fprintf(stream, "  [%d]", cells.note);
        }
        fputc('\n', stream);
    }
    fputc('\n', stream);
    const char *note = NULL;
    for (int k = 1; (note = datasheet_note(sheet, k)) != NULL; k++) {
        fprintf(stream, "[%d] %s\n", k, note);
    }
}

/* ---- Markdown ---- */

/** Write text with the characters escaped that Markdown would interpret inside a line. */
static void write_escaped(FILE *stream, const char *text)
{
    for (const char *c = text; *c != '\0'; c++) {
        const bool ends_line = *c == '\n' || *c == '\r';
        fprintf(stream, "%s%c", strchr("\\`*_{}[]<>#|~&$!", *c) != NULL ? "\\" : "", ends_line ? ' ' : *c);
    }
}

void datasheet_write_markdown(FILE *stream, const datasheet *sheet)
{
    fputs("# Data sheet of mesh ", stream);
    write_escaped(stream, sheet->name);
    fputs("\n\n", stream);
    fputs("Case ", stream);
    write_escaped(stream, sheet->path);
    fprintf(stream, ", evolvent %s%s", EVOLVENT_VERSION, sheet->title[0] == '\0' ? "" : ": ");
    write_escaped(stream, sheet->title); /* not at the start of a line, where it could be a list */
    fputc('\n', stream);
    for (int i = 0; i < sheet->n; i++) {
        const datasheet_cells cells = datasheet_format(sheet, i);
        const evl_sheet_row *row = &sheet->rows[i];
        if (datasheet_is_first(sheet, i)) {
            fprintf(stream, "\n## %s\n\n| quantity | symbol | unit | ", row->section);
            write_escaped(stream, sheet->wheels[0]);
            fputs(" | ", stream);
            write_escaped(stream, sheet->wheels[1]);
            fputs(" | note |\n|---|---|---|---:|---:|---|\n", stream);
        }
        char unit[UNIT_SPELLING_LENGTH];
        unit_typeset(cells.unit, unit);
        fputs("| ", stream);
        write_escaped(stream, row->text);
        fprintf(stream, " | %s%s%s | %s | %s | %s | ", row->symbol[0] == '\0' ? "" : "`", row->symbol,
                row->symbol[0] == '\0' ? "" : "`", unit, cells.values[0], row->n == 2 ? cells.values[1] : "");
        write_escaped(stream, row->note);
        fputs(" |\n", stream);
    }
}

/* ---- JSON ---- */

void datasheet_write_json(FILE *stream, const datasheet *sheet)
{
    json_writer writer = {.stream = stream};
    json_open(&writer, NULL, '{');
    json_text(&writer, "path", sheet->path);
    json_text(&writer, "title", sheet->title);
    json_text(&writer, "mesh", sheet->name);
    json_open(&writer, "wheels", '[');
    json_text(&writer, NULL, sheet->wheels[0]);
    json_text(&writer, NULL, sheet->wheels[1]);
    json_close(&writer, ']');
    json_open(&writer, "rows", '[');
    for (int i = 0; i < sheet->n; i++) {
        const evl_sheet_row *row = &sheet->rows[i];
        json_open(&writer, NULL, '{');
        json_text(&writer, "section", row->section);
        json_text(&writer, "key", row->key);
        json_text(&writer, "symbol", row->symbol);
        json_text(&writer, "unit", row->unit);
        json_text(&writer, "text", row->text);
        json_numbers(&writer, "values", row->n, row->value);
        json_text(&writer, "note", row->note);
        json_close(&writer, '}');
    }
    json_close(&writer, ']');
    json_close(&writer, '}');
}
