/** Allocators that never return NULL: on failure the program exits with EVL_EXIT_MEMORY and a message, and a library
 *  call returns an error. */
#pragma once

#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>

/** Attribute of a local pointer that is freed at every exit from its block. An extension of gcc and clang. clang's
 *  analyzer does not see memory allocated by the C library through it: do not use it for getline. */
#define CLEANUP_FREE __attribute__((cleanup(cleanup_free)))
static inline void cleanup_free(void *pointer)
{
    free(*(void **)pointer);
}

/** Exit with a one-line message (memory_end.c), without a signal, or leave the library call. There is no clean-up,
 *  since memory may be missing for it, too. The kernel's library looks the function up by name (no_memory.c); in a
 *  program that does not define it, a failed allocation is left to that program. */
_Noreturn void evl_memory_run_out(size_t count, size_t size);
/** count * size bytes, zeroed; never NULL. */
void *xcalloc(size_t count, size_t size);
/** Verify that `size` bytes can be allocated: for calls to code that crashes without them. */
void memory_need(size_t size);
/** Resize to count * size bytes and keep the content; never NULL. */
void *xrealloc(void *old, size_t count, size_t size);

/** Bytes of a cache line, to which allocations from an arena are aligned: loops over vectors of any length are fastest
 *  there. */
enum { MEMORY_LINE = 64 };

/** Memory freed together with its owner. All zeros: empty. */
typedef struct {
    struct memory_block *last;
} memory_arena;
/** As xcalloc; valid until arena_free, unless the arena is NULL. */
void *arena_calloc(memory_arena *arena, size_t count, size_t size);
/** Same for the many small objects of a tree that no loop iterates over: packed closely. */
void *arena_packed(memory_arena *arena, size_t count, size_t size);
/** Enlarge an array of `n` elements to count * size bytes; the bytes behind the old elements are zero. */
void *arena_grow(memory_arena *arena, const void *old, size_t n, size_t count, size_t size);
/** As xstrdup. */
char *arena_copy(memory_arena *arena, const char *text);
/** A new string formatted as by printf; valid until arena_free. */
__attribute__((format(printf, 2, 3))) char *arena_printf(memory_arena *arena, const char *format, ...);
void arena_free(memory_arena *arena);
/** Attribute of a local arena, as CLEANUP_FREE. */
#define ARENA_SCOPE __attribute__((cleanup(arena_free)))

/** A stream into memory, as open_memstream; close it by memory_close before you read the text. */
FILE *memory_open(char **text, size_t *length);
/** @param[in] text  that of memory_open; not NULL afterwards */
void memory_close(FILE *stream, char *const *text);

char *xstrdup(const char *text);
/** A new string formatted as by printf. */
__attribute__((format(printf, 1, 2))) char *xasprintf(const char *format, ...);
