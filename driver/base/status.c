#include "base/status.h"

#include "base/memory.h"
#include "base/utf8.h"

#include <errno.h>
#include <stdarg.h>
#include <string.h>

void evl_exit_print_table(FILE *stream)
{
#define EVL_EXIT_LINE(name, number, text) fprintf(stream, "  %2d  %s\n", number, text);
    EVL_EXIT_CODES(EVL_EXIT_LINE)
#undef EVL_EXIT_LINE
}

bool evl_error_set(evl_error *error, evl_exit code, const char *location, const char *format, ...)
{
    error->code = code;
    (void)snprintf(error->location, sizeof error->location, "%s", location);
    va_list arguments;
    va_start(arguments, format);
    (void)vsnprintf(error->message, sizeof error->message, format, arguments);
    va_end(arguments);
    utf8_make_line(error->location);
    utf8_make_line(error->message);
    return false;
}

bool evl_error_set_unwritten(evl_error *error, const char *path)
{
    return evl_error_set(error, EVL_EXIT_IO, path, "cannot be written: %s", strerror(errno));
}

char *evl_error_text(const evl_error *error)
{
    return xasprintf("%s: %s", error->location, error->message);
}

void evl_error_print(FILE *stream, const evl_error *error)
{
    fprintf(stream, "%s: %s\n", error->location[0] != '\0' ? error->location : "evolvent", error->message);
}
