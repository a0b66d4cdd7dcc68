#include "json.h"

#include <math.h>

#include "number.h"

static void write_text(FILE *stream, const char *text)
{
    fputc('"', stream);
    for (const char *c = text; *c != '\0'; c++) {
        if (*c == '"' || *c == '\\') {
            fprintf(stream, "\\%c", *c);
        } else if ((unsigned char)*c < 0x20) {
            fprintf(stream, "\\u%04x", (unsigned)(unsigned char)*c);
        } else {
            fputc(*c, stream);
        }
    }
    fputc('"', stream);
}

static void write_number(FILE *stream, double value)
{
    char text[NUMBER_TEXT_LENGTH];
    number_write(text, value);
    fputs(isfinite(value) ? text : "null", stream);
}

/** Comma, new line, indentation, key. */
static void begin_value(json_writer *writer, const char *key)
{
    if (writer->level > 0) {
        fprintf(writer->stream, "%s\n%*s", writer->has_values ? "," : "", 2 * writer->level, "");
    }
    if (key != NULL) {
        write_text(writer->stream, key);
        fputs(": ", writer->stream);
    }
    writer->has_values = true;
}

void json_open(json_writer *writer, const char *key, char bracket)
{
    begin_value(writer, key);
    fputc(bracket, writer->stream);
    writer->level++;
    writer->has_values = false;
}

void json_close(json_writer *writer, char bracket)
{
    writer->level--;
    if (writer->has_values) {
        fprintf(writer->stream, "\n%*s", 2 * writer->level, "");
    }
    fputc(bracket, writer->stream);
    if (writer->level == 0) {
        fputc('\n', writer->stream);
    }
    writer->has_values = true;
}

void json_text(json_writer *writer, const char *key, const char *text)
{
    begin_value(writer, key);
    write_text(writer->stream, text);
}

void json_number(json_writer *writer, const char *key, double value)
{
    begin_value(writer, key);
    write_number(writer->stream, value);
}

void json_numbers(json_writer *writer, const char *key, int n, const double *values)
{
    begin_value(writer, key);
    fputc('[', writer->stream);
    for (int i = 0; i < n; i++) {
        fputs(i == 0 ? "" : ", ", writer->stream);
        write_number(writer->stream, values[i]);
    }
    fputc(']', writer->stream);
}
