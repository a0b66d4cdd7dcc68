/** The processes that run the cases of a batch, and what goes from them to the parent. */
#pragma once

#include "batch/batch_case.h"
#include "batch/batch_queue.h"

#include <sys/types.h>

/** What the workers have to do. */
typedef struct {
    const batch_plan *plan;
    const long *todo;   /**< numbers of the cases; the queue gives places in this list */
    batch_queue *queue; /**< shared with the workers */
} batch_work;

typedef struct {
    pid_t pid;  /**< 0: none */
    int socket; /**< the parent's end; -1: none */
    char *buffer;
    size_t n_bytes, room; /**< of what has arrived and was not told yet */
    bool is_over;         /**< it was killed */
    int wait_status;      /**< then */
} batch_worker;

/** What a worker has to say of a case. */
typedef struct {
    long place;    /**< of the case in the list */
    evl_exit lost; /**< EVL_EXIT_OK, or the code with which it ends the batch: something could not be read or stored */
    batch_row row; /**< its line, or why it is lost, belongs to the receiver */
    long n_wheels; /**< that give way and were computed for it */
} batch_answer;

/** Fork a worker. It takes cases from the queue until there is none, ends when its parent does, however that ends, and ignores
 *  the signals that ask a job to end.
 *  @param number  its number for the queue, and that of its place among the workers
 *  @param first   the place in the list of a case to run before all others, -1: none
 *  @param all     [n_all] the workers that exist, whose sockets the new one must not hold
 *  @return false with the reason in `error` */
bool batch_worker_start(batch_worker *worker, const batch_work *work, int number, long first, const batch_worker *all,
                        int n_all, evl_error *error);

typedef enum { WORKER_SILENT, WORKER_ANSWERED, WORKER_GONE } batch_worker_news;
/** Take in what has arrived, without waiting, and tell one answer of it. */
batch_worker_news batch_worker_hear(batch_worker *worker, batch_answer *answer);
/** End a worker at once. What it has sent before can still be heard. */
void batch_worker_kill(batch_worker *worker);
/** Wait for the end of a worker. @return its wait status */
int batch_worker_end(batch_worker *worker);
