/* Who works in a folder keeps others out until he leaves, or ends in whatever way. */
#include <setjmp.h>
#include <signal.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmocka.h>

#include "base/lock.h"

enum { TAKEN, REFUSED, WRONG };

static char folder[] = "/tmp/evolvent-lock-XXXXXX", path[sizeof folder + 8];

static int set_up(void **state)
{
    (void)state;
    assert_non_null(mkdtemp(folder));
    (void)snprintf(path, sizeof path, "%s/lock", folder);
    return 0;
}

static int tear_down(void **state)
{
    (void)state;
    (void)unlink(path);
    return rmdir(folder);
}

/* What another process hears. */
static int another_asks(void)
{
    const pid_t child = fork();
    if (child == 0) {
        file_lock lock;
        evl_error error = {.code = EVL_EXIT_OK};
        char owner[64];
        (void)snprintf(owner, sizeof owner, "pid %ld on ", (long)getppid());
        const bool taken = file_lock_take(&lock, path, &error);
        const bool is_reported = error.code == EVL_EXIT_CASE &&
                                 strstr(error.message, "another run uses this folder") != NULL &&
                                 strstr(error.message, owner) != NULL;
        _exit(taken ? TAKEN : is_reported ? REFUSED : WRONG);
    }
    int status = 0;
    assert_true(child > 0);
    assert_int_equal(waitpid(child, &status, 0), child);
    assert_true(WIFEXITED(status));
    return WEXITSTATUS(status);
}

static void another_process_is_kept_out_until_the_lock_is_released(void **state)
{
    (void)state;
    file_lock lock;
    evl_error error;
    assert_true(file_lock_take(&lock, path, &error));
    assert_int_equal(another_asks(), REFUSED);
    assert_int_equal(another_asks(), REFUSED);
    file_lock_release(&lock);
    assert_int_equal(another_asks(), TAKEN);
}

static void a_process_that_is_killed_locks_nobody_out(void **state)
{
    (void)state;
    int ready[2];
    assert_int_equal(pipe(ready), 0);
    const pid_t child = fork();
    if (child == 0) {
        file_lock lock;
        evl_error error;
        const char word = file_lock_take(&lock, path, &error) ? '1' : '0';
        (void)!write(ready[1], &word, 1);
        (void)alarm(20); /* in case nobody kills it */
        (void)pause();
        _exit(0);
    }
    char word = '0';
    assert_true(child > 0);
    assert_int_equal(read(ready[0], &word, 1), 1);
    assert_int_equal(word, '1');
    file_lock lock;
    evl_error error;
    assert_false(file_lock_take(&lock, path, &error));
    assert_int_equal(kill(child, SIGKILL), 0);
    assert_int_equal(waitpid(child, NULL, 0), child);
    assert_true(file_lock_take(&lock, path, &error));
    file_lock_release(&lock);
    (void)close(ready[0]);
    (void)close(ready[1]);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(another_process_is_kept_out_until_the_lock_is_released),
        cmocka_unit_test(a_process_that_is_killed_locks_nobody_out),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
