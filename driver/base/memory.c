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

char *pool_copy(memory_pool *pool, const char *text)
{
    const size_t size = strlen(text) + 1;
    return memcpy(pool_calloc(pool, size, 1), text, size);
}

char *xstrdup(const char *text)
{
    return pool_copy(NULL, text);
}

/** A new string, in a pool unless that is NULL. */
static char *print(memory_pool *pool, const char *format, va_list arguments)
{
    va_list again;
    va_copy(again, arguments);
    const int length = vsnprintf(NULL, 0, format, arguments);
    const size_t size = length < 0 ? 1 : (size_t)length + 1;
    char *text = pool_calloc(pool, size, 1);
    (void)vsnprintf(text, size, format, again);
    va_end(again);
    return text;
}

char *xasprintf(const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    char *text = print(NULL, format, arguments);
    va_end(arguments);
    return text;
}

/* ---- pools ---- */

struct memory_block {
    struct memory_block *before;
    _Alignas(MEMORY_LINE) char content[];
};

/** `size` bytes, zeroed, from where a line of the cache begins. */
static void *line_calloc(size_t size)
{
    const size_t whole = (size + MEMORY_LINE - 1) / MEMORY_LINE * MEMORY_LINE;
    return memset(checked(aligned_alloc(MEMORY_LINE, whole), 1, size), 0, whole);
}

void *pool_calloc(memory_pool *pool, size_t count, size_t size)
{
    const size_t head = sizeof(struct memory_block);
    if (size > 0 && count > (SIZE_MAX - head - MEMORY_LINE) / size) {
        return checked(NULL, count, size);
    }
    if (pool == NULL) {
        return xcalloc(count, size);
    }
    struct memory_block *block = line_calloc(head + count * size);
    block->before = pool->last;
    pool->last = block;
    return block->content;
}

void *pool_grow(memory_pool *pool, const void *old, size_t n, size_t count, size_t size)
{
    void *more = pool_calloc(pool, count, size);
    return n > 0 ? memcpy(more, old, n * size) : more;
}

char *pool_printf(memory_pool *pool, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    char *text = print(pool, format, arguments);
    va_end(arguments);
    return text;
}

void pool_free(memory_pool *pool)
{
    while (pool->last != NULL) {
        struct memory_block *block = pool->last;
        pool->last = block->before;
        free(block);
    }
}
