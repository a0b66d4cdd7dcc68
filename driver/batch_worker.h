/** The processes that run the cases of a batch, and what goes between them and the parent. */
#ifndef EVOLVENT_BATCH_WORKER_H
#define EVOLVENT_BATCH_WORKER_H

#include "batch_case.h"

#include <sys/types.h>

typedef struct {
    pid_t pid;   /**< 0: none */
    int socket;  /**< the parent's end */
    long index;  /**< the case in flight; -1: none */
    int n_tries; /**< how often that was handed out */
    char *buffer;
    size_t n_bytes, room; /**< of the message that is arriving */
} batch_worker;

/** What a worker has to say of the case in flight. */
typedef struct {
    bool is_lost;    /**< its row could not be stored on disk: `text` says why */
    batch_row row;   /**< otherwise; its line belongs to the receiver */
    evl_error error; /**< of is_lost */
} batch_answer;

/** Fork a worker. It ends when its parent does, however that ends, and ignores the signals that ask a job to end.
 *  @param all  [n_all] the workers that exist, whose sockets the new one must not hold
 *  @return false with the reason in `error` */
bool batch_worker_start(batch_worker *worker, const batch_plan *plan, const batch_worker *all, int n_all,
                        evl_error *error);
/** Hand a case out. That the worker is gone shows in batch_worker_hear. */
void batch_worker_give(batch_worker *worker, long index, int n_tries);

typedef enum { WORKER_SILENT, WORKER_ANSWERED, WORKER_GONE } batch_worker_news;
/** Take in what has arrived, without waiting. */
batch_worker_news batch_worker_hear(batch_worker *worker, batch_answer *answer);
/** Wait for a worker that is gone, or end one that is not. @return its wait status */
int batch_worker_end(batch_worker *worker, bool kill_it);

#endif
