/** The cases of a batch, taken by its workers one by one. Nobody has to hand them out: a worker never waits for the parent, and
 *  all are busy until the last case is taken. */
#pragma once

#include <signal.h>
#include <stdbool.h>

/** Lies in memory that a process shares with those it forks. */
typedef struct batch_queue batch_queue;

/** Places 0 to n - 1 for workers 0 to n_workers - 1. @return NULL, with errno, if there is no such memory */
batch_queue *batch_queue_create(long n, int n_workers);
void batch_queue_delete(batch_queue **queue);

/** The next place for a worker; -1: none is left. */
long batch_queue_take(batch_queue *queue, int worker);
/** The place that a worker took last, whether it is done with it or not; -1: none. A worker that dies while it takes one may not
 *  have noted it yet: that place is lost. */
long batch_queue_last(const batch_queue *queue, int worker);
/** All places are there again, n of them; no worker may be at work. */
void batch_queue_restart(batch_queue *queue, long n);
/** Ask the workers to end: nothing is taken any more, and who runs a case puts it away. */
void batch_queue_stop(batch_queue *queue);
bool batch_queue_is_stopped(const batch_queue *queue);
/** The same as a number that is not 0 then. */
const volatile sig_atomic_t *batch_queue_stop_word(const batch_queue *queue);
