#include "library/boundary.h"

#include "base/memory.h"

#include <fenv.h>
#include <locale.h>
#include <pthread.h>
#include <setjmp.h>

/* Minimum memory of a call, in bytes: the tables of the kernel, which are created once and completely. */
enum { NEEDED = 8 * 1024 * 1024 };

typedef struct {
    jmp_buf start;
    size_t count, size; /* of the failed allocation */
} boundary;

static _Thread_local boundary *innermost; /* NULL: this thread is not in a call */

static pthread_once_t once = PTHREAD_ONCE_INIT;
static locale_t plain; /* 0: not available, and the caller's locale applies */

static void make_locale(void)
{
    plain = newlocale(LC_ALL_MASK, "C", (locale_t)0);
}

void boundary_leave(size_t count, size_t size)
{
    if (innermost != NULL) {
        innermost->count = count;
        innermost->size = size;
        longjmp(innermost->start, 1);
    }
}

static void work_inside(boundary *b, void (*work)(void *with), void *with, evl_error *error)
{
    if (setjmp(b->start) == 0) {
        memory_need(NEEDED);
        work(with);
    } else {
        evl_error_set(error, EVL_EXIT_MEMORY, "", "out of memory: %zu x %zu bytes are not available", b->count,
                      b->size);
    }
}

void boundary_call(void (*work)(void *with), void *with, evl_error *error)
{
    boundary b, *outer = innermost;
    fenv_t floating;
    (void)pthread_once(&once, make_locale);
    const locale_t locale = plain == (locale_t)0 ? (locale_t)0 : uselocale(plain);
    (void)fegetenv(&floating);
    (void)fesetenv(FE_DFL_ENV);
    innermost = &b;
    work_inside(&b, work, with, error);
    innermost = outer;
    (void)fesetenv(&floating);
    if (locale != (locale_t)0) {
        (void)uselocale(locale);
    }
}
