#include "base/json.h"

#include "base/number.h"
#include "base/utf8.h"

#include <math.h>

/** Length of the start of a text that needs no escaping. */
static size_t ordinary_length(const char *text)
{
    size_t n = 0;
    for (unsigned char c = (unsigned char)text[0]; c >= 0x20 && c < 0x80 && c != '"' && c != '\\';) {
        c = (unsigned char)text[++n];
    }
    return n;
}

/** Invalid UTF-8, such as a truncated character, becomes the replacement character. */
static void write_text(FILE *stream, const char *text)
{
    fputc('"', stream);
    for (const char *c = text; *c != '\0';) {
        const size_t n = ordinary_length(c);
        (void)fwrite(c, 1, n, stream);
        c += n;
        if (*c == '\0') {
            break;
        }
        const int length = utf8_length(c);
        if (length == 0) {
            fputs("\xef\xbf\xbd", stream);
        } else if (length > 1) {
            (void)fwrite(c, 1, (size_t)length, stream);
        } else if (*c == '"' || *c == '\\') {
            fprintf(stream, "\\%c", *c);
        } else {
            fprintf(stream, "\\u%04x", (unsigned)(unsigned char)*c);
        }
        c += length > 1 ? length : 1;
    }
    fputc('"', stream);
}

static void write_number(const json_writer *writer, double value)
{
    char text[NUMBER_TEXT_LENGTH] = "null";
    if (isfinite(value) && writer->is_line) {
        number_write_plain(text, value); /* the shortest text is expensive to find */
    } else if (isfinite(value)) {
        number_write(text, value);
    }
    fputs(text, writer->stream);
}

static void break_line(const json_writer *writer)
{
    if (!writer->is_line) {
        fprintf(writer->stream, "\n%*s", 2 * writer->level, "");
    }
}

/** Comma, new line, indentation, key. */
static void begin_value(json_writer *writer, const char *key)
{
    if (writer->level > 0) {
        fputs(writer->has_values ? "," : "", writer->stream);
        break_line(writer);
    }
    if (key != NULL) {
        write_text(writer->stream, key);
        fputs(writer->is_line ? ":" : ": ", writer->stream);
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
        break_line(writer);
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
    write_number(writer, value);
}

void json_numbers(json_writer *writer, const char *key, int n, const double *values)
{
    begin_value(writer, key);
    fputc('[', writer->stream);
    for (int i = 0; i < n; i++) {
        fputs(i == 0 ? "" : writer->is_line ? "," : ", ", writer->stream);
        write_number(writer, values[i]);
    }
    fputc(']', writer->stream);
}

void json_integer(json_writer *writer, const char *key, long value)
{
    begin_value(writer, key);
    fprintf(writer->stream, "%ld", value);
}

void json_truth(json_writer *writer, const char *key, bool value)
{
    begin_value(writer, key);
    fputs(value ? "true" : "false", writer->stream);
}
