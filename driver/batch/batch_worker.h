/** Worker processes of a batch, and their messages to the parent. */
#pragma once

#include "batch/batch_case.h"
#include "batch/batch_queue.h"

#include <sys/types.h>

/** Work of the workers. */
typedef struct {
    const batch_plan *plan;
    const long *todo;   /**< numbers of the cases; the queue holds indices in this list */
    batch_queue *queue; /**< shared with the workers */
} batch_work;

typedef struct {
    pid_t pid;  /**< 0: none */
    int socket; /**< the parent's end; -1: none */
    char *buffer;
    size_t n_bytes, capacity; /**< received and not yet processed */
    bool is_over;             /**< it was killed */
    int wait_status;          /**< then */
} batch_worker;

/** Message of a worker about a case. */
typedef struct {
    long index;    /**< index of the case in the list */
    evl_exit lost; /**< EVL_EXIT_OK, or the code with which it ends the batch: data could not be read or stored */
    batch_row row; /**< its line, or the reason of the failure; belongs to the receiver */
    long n_wheels; /**< number of compliant wheels computed for it */
} batch_reply;

/** Fork a worker. It takes cases from the queue until it is empty, and ends when its parent does, however that ends. It
 *  ignores the signals that request the end of a job.
 *  @param number  its index in the queue and in the array of workers
 *  @param first   index in the list of a case to run before all others, -1: none
 *  @param all     [n_all] existing workers, whose sockets the new one must not hold
 *  @return false with the reason in `error` */
bool batch_worker_start(batch_worker *worker, const batch_work *work, int number, long first, const batch_worker *all,
                        int n_all, evl_error *error);

typedef enum { WORKER_SILENT, WORKER_REPLIED, WORKER_GONE } batch_worker_news;
/** Receive the available data, without waiting, and return one message. */
batch_worker_news batch_worker_hear(batch_worker *worker, batch_reply *reply);
/** Kill a worker at once. Data that it has sent can still be received. */
void batch_worker_kill(batch_worker *worker);
/** Wait for the end of a worker. @return its wait status */
int batch_worker_end(batch_worker *worker);
