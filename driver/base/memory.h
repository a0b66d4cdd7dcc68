/** Memory that is there, or the program ends with a message and EVL_EXIT_MEMORY, and a call of the library with an error: nothing
 *  sensible can be done without it. */
#pragma once

#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>

/** For a local pointer that is freed where its block ends, however that is left. An extension of gcc and clang, by which
 *  clang's analyzer cannot see what the C library itself has allocated: not for getline. */
#define OWNED __attribute__((cleanup(free_owned)))
static inline void free_owned(void *pointer)
{
    free(*(void **)pointer);
}

/** End the program with one line, without a signal (memory_end.c), or leave the library's call; nothing is tidied up, for which
 *  memory may be missing, too. The kernel's library finds it by name (no_memory.c): in another program, which has none, it goes on
 *  without memory as that program would. */
_Noreturn void evl_memory_run_out(size_t count, size_t size);
/** count * size bytes, zeroed; never NULL. */
void *xcalloc(size_t count, size_t size);
/** See that so many bytes can be had: for who calls what would crash without them. */
void memory_need(size_t size);
/** count * size bytes with the old content; never NULL. */
void *xrealloc(void *old, size_t count, size_t size);

/** Bytes of a line of the cache, on which what a pool gives begins: loops over vectors of any length are fastest there. */
enum { MEMORY_LINE = 64 };

/** What is given back together with its owner. Zeros: nothing yet. */
typedef struct {
    struct memory_block *last;
} memory_pool;
/** As xcalloc; it lasts until pool_free, unless the pool is NULL. */
void *pool_calloc(memory_pool *pool, size_t count, size_t size);
/** The same for the many small things of a tree, which no loop goes over: they lie close together. */
void *pool_packed(memory_pool *pool, size_t count, size_t size);
/** More room for `n` things: count * size bytes, zeroed behind the old ones. */
void *pool_grow(memory_pool *pool, const void *old, size_t n, size_t count, size_t size);
/** As xstrdup. */
char *pool_copy(memory_pool *pool, const char *text);
/** A new string as printf would print it; it lasts until pool_free. */
__attribute__((format(printf, 2, 3))) char *pool_printf(memory_pool *pool, const char *format, ...);
void pool_free(memory_pool *pool);
/** For a local pool, as OWNED. */
#define POOLED __attribute__((cleanup(pool_free)))

/** A stream into memory, as of open_memstream; to be closed by memory_close, and only then to be read. */
FILE *memory_open(char **text, size_t *length);
/** @param[in] text  that of memory_open: there is one afterwards */
void memory_close(FILE *stream, char *const *text);

char *xstrdup(const char *text);
/** A new string as printf would print it. */
__attribute__((format(printf, 1, 2))) char *xasprintf(const char *format, ...);
