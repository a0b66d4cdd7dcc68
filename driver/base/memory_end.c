/* Exit of the program when memory runs out. The library handles this differently (library/boundary.c). */
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

/* gfortran's library ends the program through these functions when an `allocate` fails, with several lines and exit
 * code 1. The kernel calls the first definition that the linker finds, which is this one. It is weak so that the
 * library can define its own when linked statically. */
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
/* A text without trailing blanks: the kernel's most frequent allocation by that library. */
__attribute__((weak)) void _gfortran_string_trim(size_t *length, void **made, size_t n, const char *text);

void _gfortran_string_trim(size_t *length, void **made, size_t n, const char *text)
{
    while (n > 0 && text[n - 1] == ' ') {
        n--;
    }
    *length = n;
    *made = n > 0 ? memcpy(xcalloc(n, 1), text, n) : NULL;
}
/* NOLINTEND(bugprone-reserved-identifier) */
