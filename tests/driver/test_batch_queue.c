/* The cases of a batch: processes that take them at the same time take each of them once. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmocka.h>

#include "batch/batch_queue.h"

enum { N_CASES = 20000, WORKERS = 4 };

/* Takes all it gets and tells each through the pipe. */
static void take_all(batch_queue *queue, int worker, int pipe)
{
    for (long index = batch_queue_take(queue, worker); index >= 0; index = batch_queue_take(queue, worker)) {
        if (batch_queue_last(queue, worker) != index || write(pipe, &index, sizeof index) != sizeof index) {
            _exit(1);
        }
    }
    _exit(0);
}

static void every_place_is_taken_once_by_whichever_worker(void **state)
{
    (void)state;
    static int times[N_CASES];
    int ends[2];
    batch_queue *queue = batch_queue_create(N_CASES, WORKERS);
    assert_non_null(queue);
    assert_int_equal(pipe(ends), 0);
    for (int i = 0; i < WORKERS; i++) {
        const pid_t pid = fork();
        assert_true(pid >= 0);
        if (pid == 0) {
            take_all(queue, i, ends[1]);
        }
    }
    assert_int_equal(close(ends[1]), 0);
    long index = -1;
    while (read(ends[0], &index, sizeof index) == sizeof index) {
        assert_in_range(index, 0, N_CASES - 1);
        times[index]++;
    }
    for (int i = 0; i < WORKERS; i++) {
        int status = -1;
        assert_true(wait(&status) > 0);
        assert_int_equal(status, 0);
    }
    for (int i = 0; i < N_CASES; i++) {
        assert_int_equal(times[i], 1);
    }
    assert_int_equal(close(ends[0]), 0);
    batch_queue_delete(&queue);
    assert_null(queue);
}

static void a_queue_that_is_started_again_has_all_its_places(void **state)
{
    (void)state;
    batch_queue *queue = batch_queue_create(2, 1);
    assert_non_null(queue);
    assert_int_equal(batch_queue_last(queue, 0), -1);
    assert_int_equal(batch_queue_take(queue, 0), 0);
    assert_int_equal(batch_queue_take(queue, 0), 1);
    assert_int_equal(batch_queue_take(queue, 0), -1);
    assert_int_equal(batch_queue_last(queue, 0), 1);
    batch_queue_restart(queue, 1);
    assert_int_equal(batch_queue_last(queue, 0), -1);
    assert_int_equal(batch_queue_take(queue, 0), 0);
    assert_int_equal(batch_queue_take(queue, 0), -1);
    batch_queue_delete(&queue);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_place_is_taken_once_by_whichever_worker),
        cmocka_unit_test(a_queue_that_is_started_again_has_all_its_places),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
