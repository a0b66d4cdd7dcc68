#include "commands/completion.h"

#include <string.h>

word_kind completion_kind(const char *called)
{
    static const struct {
        const char *called;
        word_kind kind;
    } rows[] = {
        {"case file", WORD_CASE},       {"design", WORD_DESIGN},   {"folder", WORD_FOLDER},
        {COMPLETION_SHELL, WORD_SHELL}, {"HISTORY.h5", WORD_FILE}, {"FILE.h5", WORD_FILE},
        {"FILE.fmu", WORD_FILE},        {"FILE", WORD_FILE},       {"DIR", WORD_FOLDER},
        {"PATH=VALUE", WORD_SETTING},   {"NAME", WORD_MESH},       {"NAMES", WORD_OUTPUTS},
    };
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        if (strcmp(rows[i].called, called) == 0) {
            return rows[i].kind;
        }
    }
    return WORD_ANY;
}

void completion_print_quoted(FILE *stream, const char *text, const char *escape)
{
    fputc('\'', stream);
    for (const char *c = text; *c != '\0'; c++) {
        if (*c == '\'') {
            fputs("'\\''", stream); /* ends the quotes, adds an escaped quote, starts the quotes again */
        } else {
            fprintf(stream, "%s%c", strchr(escape, *c) != NULL ? "\\" : "", *c);
        }
    }
    fputc('\'', stream);
}
