#include "base/memory.h"

#include <stdarg.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void *checked(void *memory, size_t count, size_t size)
{
    if (memory == NULL) {
        evl_memory_run_out(count, size);
    }
    return memory;
}

void memory_need(size_t size)
{
    free(checked(malloc(size), 1, size));
}

FILE *memory_open(char **text, size_t *length)
{
    return checked(open_memstream(text, length), 1, BUFSIZ);
}

void memory_close(FILE *stream, char *const *text)
{
    const bool is_short = ferror(stream) != 0;
    if (fclose(stream) != 0 || is_short || *text == NULL) { /* the C library frees it if it cannot be shortened */
        evl_memory_run_out(1, BUFSIZ);
    }
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

char *arena_copy(memory_arena *arena, const char *text)
{
    const size_t size = strlen(text) + 1;
    return memcpy(arena_packed(arena, size, 1), text, size);
}

char *xstrdup(const char *text)
{
    return arena_copy(NULL, text);
}

/** Print to a new string, in an arena unless that is NULL. */
static char *print(memory_arena *arena, const char *format, va_list arguments)
{
    va_list again;
    va_copy(again, arguments);
    const int length = vsnprintf(NULL, 0, format, arguments);
    const size_t size = length < 0 ? 1 : (size_t)length + 1;
    char *text = arena_packed(arena, size, 1);
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
    size_t size, used; /* bytes of the content */
    _Alignas(MEMORY_LINE) char content[];
};

enum {
    FIRST_BLOCK = 1024,
    LARGEST_BLOCK = 64 * 1024,
    PART = 4, /* allocations larger than this part of a block get a block of their own */
#ifdef __SANITIZE_ADDRESS__
    SHARES_BLOCKS = 0 /* so that an access beyond an allocation is detected */
#else
    SHARES_BLOCKS = 1
#endif
};

static size_t rounded_up(size_t size, size_t alignment)
{
    return (size + alignment - 1) / alignment * alignment;
}

static struct memory_block *block_create(size_t size)
{
    const size_t whole = rounded_up(sizeof(struct memory_block) + size, MEMORY_LINE);
    struct memory_block *block = checked(aligned_alloc(MEMORY_LINE, whole), 1, size);
    *block = (struct memory_block){.size = whole - sizeof *block};
    return block;
}

/** Allocate a block of its own, behind the one that is being filled. */
static void *take_alone(memory_arena *arena, size_t size)
{
    struct memory_block *block = block_create(size), **list = arena->last == NULL ? &arena->last : &arena->last->before;
    block->before = *list;
    block->used = block->size;
    *list = block;
    return block->content;
}

/** Allocate in the block that is being filled, in a block of its own, or in a new block for this and others. */
static void *take_shared(memory_arena *arena, size_t size, size_t alignment)
{
    const struct memory_block *last = arena->last;
    const size_t next = last == NULL ? FIRST_BLOCK : 2 * last->size < LARGEST_BLOCK ? 2 * last->size : LARGEST_BLOCK;
    const size_t begin = last == NULL ? 0 : rounded_up(last->used, alignment);
    if (last != NULL && begin + size <= last->size) {
        arena->last->used = begin + size;
        return arena->last->content + begin;
    }
    if (size > next / PART) {
        return take_alone(arena, size);
    }
    struct memory_block *block = block_create(next);
    block->before = arena->last;
    block->used = size;
    arena->last = block;
    return block->content;
}

static void *take(memory_arena *arena, size_t count, size_t size, size_t alignment)
{
    const size_t head = sizeof(struct memory_block);
    if (size > 0 && count > (SIZE_MAX - head - MEMORY_LINE) / size) {
        return checked(NULL, count, size);
    }
    if (arena == NULL) {
        return xcalloc(count, size);
    }
    const size_t bytes = count * size > 0 ? count * size : 1;
    return memset(SHARES_BLOCKS ? take_shared(arena, bytes, alignment) : take_alone(arena, bytes), 0, bytes);
}

void *arena_calloc(memory_arena *arena, size_t count, size_t size)
{
    return take(arena, count, size, MEMORY_LINE);
}

void *arena_packed(memory_arena *arena, size_t count, size_t size)
{
    return take(arena, count, size, size == 1 ? 1 : _Alignof(max_align_t));
}

void *arena_grow(memory_arena *arena, const void *old, size_t n, size_t count, size_t size)
{
    void *more = arena_calloc(arena, count, size);
    return n > 0 ? memcpy(more, old, n * size) : more;
}

char *arena_printf(memory_arena *arena, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    char *text = print(arena, format, arguments);
    va_end(arguments);
    return text;
}

void arena_free(memory_arena *arena)
{
    while (arena->last != NULL) {
        struct memory_block *block = arena->last;
        arena->last = block->before;
        free(block);
    }
}
