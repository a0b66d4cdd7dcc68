#include "base/memory.h"

#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void *checked(void *memory, size_t count, size_t size)
{
    if (memory == NULL) {
        fprintf(stderr, "evolvent: out of memory: %zu x %zu bytes are not available\n", count, size);
        abort();
    }
    return memory;
}

void *xcalloc(size_t count, size_t size)
{
    if (count == 0 || size == 0) {
        count = size = 1;
    }
    return checked(calloc(count, size), count, size);
}

void *xrealloc(void *old, size_t count, size_t size)
{
    if (count == 0 || size == 0) {
        count = size = 1;
    }
    if (count > SIZE_MAX / size) {
        return checked(NULL, count, size);
    }
    return checked(realloc(old, count * size), count, size);
}

char *xstrdup(const char *text)
{
    const size_t size = strlen(text) + 1;
    return memcpy(xcalloc(size, 1), text, size);
}

char *xasprintf(const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    const int length = vsnprintf(NULL, 0, format, arguments);
    va_end(arguments);
    const size_t size = length < 0 ? 1 : (size_t)length + 1;
    char *text = xcalloc(size, 1);
    va_start(arguments, format);
    (void)vsnprintf(text, size, format, arguments);
    va_end(arguments);
    return text;
}
