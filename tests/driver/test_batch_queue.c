/* The cases of a batch: processes that take them at the same time take each of them once. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmocka.h>

#include "batch/batch_queue.h"

enum { PLACES = 20000, WORKERS = 4 };

/* Takes all it gets and tells each through the pipe. */
static void take_all(batch_queue *queue, int worker, int pipe)
{
    for (long place = batch_queue_take(queue, worker); place >= 0; place = batch_queue_take(queue, worker)) {
        if (batch_queue_last(queue, worker) != place || write(pipe, &place, sizeof place) != sizeof place) {
            _exit(1);
        }
    }
    _exit(0);
}

static void every_place_is_taken_once_by_whichever_worker(void **state)
{
    (void)state;
    static int times[PLACES];
    int ends[2];
    batch_queue *queue = batch_queue_create(PLACES, WORKERS);
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
    long place = -1;
    while (read(ends[0], &place, sizeof place) == sizeof place) {
        assert_in_range(place, 0, PLACES - 1);
        times[place]++;
    }
    for (int i = 0; i < WORKERS; i++) {
        int status = -1;
        assert_true(wait(&status) > 0);
        assert_int_equal(status, 0);
    }
    for (int i = 0; i < PLACES; i++) {
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
