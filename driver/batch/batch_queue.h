/** Queue of the cases of a batch, from which workers take them one by one. A worker never waits for the parent, and all
 *  are busy until the last case is taken. */
#pragma once

#include <signal.h>
#include <stdbool.h>

/** In memory shared by a process and its forks. */
typedef struct batch_queue batch_queue;

/** Indices 0 to n - 1 for workers 0 to n_workers - 1. @return NULL, with errno, if there is no shared memory */
batch_queue *batch_queue_create(long n, int n_workers);
void batch_queue_delete(batch_queue **queue);

/** Next index for a worker; -1: none is left. */
long batch_queue_take(batch_queue *queue, int worker);
/** Last index taken by a worker, whether finished or not; -1: none. If a worker dies while it takes one, the index may
 *  not be recorded yet and is lost. */
long batch_queue_last(const batch_queue *queue, int worker);
/** Fill the queue again with n indices; no worker may be running. */
void batch_queue_restart(batch_queue *queue, long n);
/** Stop the workers: no more indices are given out, and a running case is stopped with a checkpoint. */
void batch_queue_stop(batch_queue *queue);
bool batch_queue_is_stopped(const batch_queue *queue);
/** Same as a flag that is not 0 when stopped. */
const volatile sig_atomic_t *batch_queue_stop_word(const batch_queue *queue);
