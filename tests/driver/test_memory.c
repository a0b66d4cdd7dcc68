/* A text that is written in memory: whole when it is closed, or the program ends for lack of memory. */
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmocka.h>

#include "base/memory.h"
#include "base/status.h"

static void a_text_in_memory_is_whole_once_it_is_closed(void **state)
{
    (void)state;
    char *text;
    size_t length;
    FILE *stream = memory_open(&text, &length);
    for (int i = 0; i < 10000; i++) {
        (void)fputs("0123456789", stream);
    }
    memory_close(stream, &text);
    assert_int_equal(length, 100000);
    assert_int_equal(strlen(text), length);
    free(text);
}

/* How a process ends that closes what the C library, which found no memory to shorten a text, leaves of it. */
static int end_of_a_text(const char *name, const char *mode, bool is_there)
{
    const pid_t child = fork();
    if (child == 0) {
        char *text = is_there ? "" : NULL;
        FILE *stream = fopen(name, mode);
        if (stream == NULL) {
            _exit(EVL_EXIT_USAGE);
        }
        (void)fputs("more than nothing", stream);
        (void)close(STDERR_FILENO); /* its line */
        memory_close(stream, &text);
        _exit(0);
    }
    int status;
    assert_int_equal(waitpid(child, &status, 0), child);
    assert_true(WIFEXITED(status));
    return WEXITSTATUS(status);
}

static void a_text_that_could_not_be_shortened_or_written_ends_the_program(void **state)
{
    (void)state;
    assert_int_equal(end_of_a_text("/dev/null", "w", true), 0);
    assert_int_equal(end_of_a_text("/dev/null", "w", false), EVL_EXIT_MEMORY);
    assert_int_equal(end_of_a_text("/dev/full", "w", true), EVL_EXIT_MEMORY);
    assert_int_equal(end_of_a_text("/dev/null", "r", true),
                     EVL_EXIT_MEMORY); /* the stream is in error, its end is not */
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_text_in_memory_is_whole_once_it_is_closed),
        cmocka_unit_test(a_text_that_could_not_be_shortened_or_written_ends_the_program),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
