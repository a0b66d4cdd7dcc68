/* Wrappers of the allocators for the linker (--wrap), in the program and in the kernel's library: if memory runs out,
 * the program ends with one line. Callers need not check the result; some do not: temporaries of gfortran, tables of
 * HDF5. */
#include <stdlib.h>
#include <string.h>

/* Of memory.h, which the kernel does not include: defined by the program, or absent if the kernel belongs to another
 * program. */
__attribute__((weak)) void evl_memory_run_out(size_t count, size_t size);

/* The names are given by the linker. NOLINTBEGIN(bugprone-reserved-identifier) */
void *__real_malloc(size_t size);
void *__real_calloc(size_t count, size_t size);
void *__real_realloc(void *old, size_t size);
char *__real_strdup(const char *text);
void *__wrap_malloc(size_t size);
void *__wrap_calloc(size_t count, size_t size);
void *__wrap_realloc(void *old, size_t size);
char *__wrap_strdup(const char *text);

static void *checked(void *memory, size_t count, size_t size)
{
    if (memory == NULL && count > 0 && size > 0 && evl_memory_run_out != NULL) {
        evl_memory_run_out(count, size);
    }
    return memory;
}

void *__wrap_malloc(size_t size)
{
    return checked(__real_malloc(size), 1, size);
}

void *__wrap_calloc(size_t count, size_t size)
{
    return checked(__real_calloc(count, size), count, size);
}

void *__wrap_realloc(void *old, size_t size)
{
    return checked(__real_realloc(old, size), 1, size);
}

char *__wrap_strdup(const char *text)
{
    return checked(__real_strdup(text), 1, strlen(text) + 1);
}
/* NOLINTEND(bugprone-reserved-identifier) */
