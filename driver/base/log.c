#include "base/log.h"

#include "base/utf8.h"

#include <stdarg.h>
#include <stdio.h>

static bool is_quiet;

void log_set_quiet(bool quiet)
{
    is_quiet = quiet;
}

static void write_line(const char *kind, const char *format, va_list arguments)
{
    char text[2048];
    (void)vsnprintf(text, sizeof text, format, arguments);
    utf8_make_line(text);
    fprintf(stderr, "evolvent: %s%s\n", kind, text);
}

void log_note(const char *format, ...)
{
    if (is_quiet) {
        return;
    }
    va_list arguments;
    va_start(arguments, format);
    write_line("", format, arguments);
    va_end(arguments);
}

void log_warning(const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    write_line("warning: ", format, arguments);
    va_end(arguments);
}
