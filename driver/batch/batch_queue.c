/* MAP_ANONYMOUS is newer than the POSIX version required by the rest. */
#define _DEFAULT_SOURCE  // NOLINT(bugprone-reserved-identifier)
#define _DARWIN_C_SOURCE // NOLINT(bugprone-reserved-identifier)
#include "batch/batch_queue.h"

#include <stdatomic.h>
#include <stddef.h>
#include <sys/mman.h>

struct batch_queue {
    size_t size; /**< of the complete struct [bytes] */
    int n_workers;
    atomic_bool is_stopped;
    volatile sig_atomic_t stop; /**< the same */
    atomic_long n, next;
    atomic_long last[]; /**< [n_workers] */
};

batch_queue *batch_queue_create(long n, int n_workers)
{
    const size_t size = sizeof(batch_queue) + (size_t)n_workers * sizeof(atomic_long);
    batch_queue *queue = mmap(NULL, size, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (queue == MAP_FAILED) {
        return NULL;
    }
    queue->size = size;
    queue->n_workers = n_workers;
    batch_queue_restart(queue, n);
    return queue;
}

void batch_queue_delete(batch_queue **queue)
{
    if (*queue != NULL) {
        (void)munmap(*queue, (*queue)->size);
    }
    *queue = NULL;
}

void batch_queue_restart(batch_queue *queue, long n)
{
    atomic_store(&queue->is_stopped, false);
    queue->stop = 0;
    atomic_store(&queue->n, n);
    atomic_store(&queue->next, 0);
    for (int i = 0; i < queue->n_workers; i++) {
        atomic_store(&queue->last[i], -1);
    }
}

long batch_queue_take(batch_queue *queue, int worker)
{
    if (batch_queue_is_stopped(queue) || atomic_load(&queue->next) >= atomic_load(&queue->n)) {
        return -1;
    }
    const long index = atomic_fetch_add(&queue->next, 1);
    if (index >= atomic_load(&queue->n)) {
        return -1;
    }
    atomic_store(&queue->last[worker], index);
    return index;
}

long batch_queue_last(const batch_queue *queue, int worker)
{
    return atomic_load(&queue->last[worker]);
}

void batch_queue_stop(batch_queue *queue)
{
    atomic_store(&queue->is_stopped, true);
    queue->stop = 1;
}

bool batch_queue_is_stopped(const batch_queue *queue)
{
    return atomic_load_explicit(&queue->is_stopped, memory_order_relaxed);
}

const volatile sig_atomic_t *batch_queue_stop_word(const batch_queue *queue)
{
    return &queue->stop;
}
