/* How the program ends where there is no memory. The library has another answer (library/boundary.c). */
#include "base/memory.h"
#include "base/status.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

void evl_memory_run_out(size_t count, size_t size)
{
    char text[128];
    const int n =
        snprintf(text, sizeof text, "evolvent: out of memory: %zu x %zu bytes are not available\n", count, size);
    (void)!write(STDERR_FILENO, text, (size_t)n);
    _exit(EVL_EXIT_MEMORY);
}

/* gfortran's library ends the program by these where an `allocate` fails, with several lines and exit code 1. The kernel calls the
 * first definition that is found, which is this one; weak, for the library to have its own where it is linked statically. */
/* NOLINTBEGIN(bugprone-reserved-identifier) */
__attribute__((weak)) _Noreturn void _gfortran_os_error(const char *message);
__attribute__((weak)) _Noreturn void _gfortran_os_error_at(const char *where, const char *format, ...);

_Noreturn void _gfortran_os_error(const char *message)
{
    (void)message;
    evl_memory_run_out(1, 1);
}

_Noreturn void _gfortran_os_error_at(const char *where, const char *format, ...)
{
    (void)where;
    va_list arguments;
    va_start(arguments, format); /* "Error allocating %lu bytes" */
    const unsigned long size = strstr(format, "%lu") != NULL ? va_arg(arguments, unsigned long) : 1;
    va_end(arguments);
    evl_memory_run_out(1, size);
}
/* NOLINTEND(bugprone-reserved-identifier) */
