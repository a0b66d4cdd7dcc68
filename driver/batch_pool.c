#include "batch_pool.h"

#include "batch_worker.h"
#include "interrupt.h"
#include "log.h"
#include "memory.h"

#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

enum { MOST_TRIES = 2, LOOK_MILLISECONDS = 200 };
static const double sync_interval = 1.0;       /* [s] between two times that all is brought to the disk */
static const double terminal_interval = 1.0;   /* [s] between two lines of progress on a terminal */
static const double elsewhere_interval = 60.0; /* [s] and in a log */

typedef struct {
    const batch_plan *plan;
    batch_state *state;
    evl_error *error;
    int n_workers;
    batch_worker *workers;
    long n_given; /**< of state->todo */
    long n_bad;   /**< failed or refused in this run */
    double started, synced, shown;
    bool show_progress, is_terminal;
} pool;

double batch_clock(void)
{
    struct timespec now;
    (void)clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* ---- what is to be seen and to be safe ---- */

static void show_progress(const pool *pool, double now)
{
    const batch_state *state = pool->state;
    const double rate = (double)state->n_finished / (now - pool->started);
    char left[48] = "";
    if (rate > 0) {
        const double seconds = (double)(state->n_todo - state->n_finished) / rate;
        (void)snprintf(left, sizeof left, seconds < 3600 ? ", %.0f s left" : ", %.1f h left",
                       seconds < 3600 ? seconds : seconds / 3600);
    }
    char text[200];
    (void)snprintf(text, sizeof text, "%ld of %ld done, %ld of them failed or refused, %.3g a second%s",
                   state->n_finished, state->n_todo, pool->n_bad, rate, left);
    if (pool->is_terminal) {
        fprintf(stderr, "\r%s\x1b[K", text);
        (void)fflush(stderr);
    } else {
        log_note("%s", text);
    }
}

static void wipe_progress(const pool *pool)
{
    if (pool->is_terminal && pool->show_progress) {
        fputs("\r\x1b[K", stderr);
        (void)fflush(stderr);
    }
}

/** Histories first: a row that is recorded has one. @return false if the disk does not take it */
static bool sync_all(pool *pool)
{
    const stack *stack = &pool->plan->stack;
    journal *journal = &pool->state->journal;
    if (!journal->is_dirty) {
        return true;
    }
    return (stack->descriptor < 0 || stack_sync(stack, pool->error)) && journal_sync(journal, pool->error);
}

static bool look_at_clock(pool *pool)
{
    const double now = batch_clock();
    if (pool->show_progress && now - pool->shown >= (pool->is_terminal ? terminal_interval : elsewhere_interval)) {
        show_progress(pool, now);
        pool->shown = now;
    }
    if (now - pool->synced < sync_interval) {
        return true;
    }
    pool->synced = now;
    return sync_all(pool);
}

/* ---- cases out, rows in ---- */

static void give_next(pool *pool, batch_worker *worker)
{
    if (pool->n_given < pool->state->n_todo) {
        batch_worker_give(worker, pool->state->todo[pool->n_given++], 1);
    }
}

static bool record(pool *pool, long index, batch_row *row)
{
    const bool good = journal_append(&pool->state->journal, row->line, row->length, pool->error);
    if (good) {
        pool->state->status[index] = row->status;
        pool->state->n_finished++;
        pool->n_bad += row->status == JOURNAL_DONE ? 0 : 1;
    }
    free(row->line);
    return good;
}

static bool start_worker(pool *pool, batch_worker *worker)
{
    return batch_worker_start(worker, pool->plan, pool->workers, pool->n_workers, pool->error);
}

/** A worker died in the middle of a case: once that may be anyone's fault, twice it is the case's. */
static bool replace_worker(pool *pool, batch_worker *worker)
{
    const long index = worker->index;
    const int n_tries = worker->n_tries, status = batch_worker_end(worker, false);
    if (!start_worker(pool, worker)) {
        return false;
    }
    if (index >= 0 && n_tries < MOST_TRIES) {
        batch_worker_give(worker, index, n_tries + 1);
        return true;
    }
    bool good = true;
    if (index >= 0) {
        char message[128];
        batch_row row;
        if (WIFSIGNALED(status)) {
            (void)snprintf(message, sizeof message, "the process that ran it was ended by signal %d (%s), twice",
                           WTERMSIG(status), strsignal(WTERMSIG(status)));
        } else {
            (void)snprintf(message, sizeof message, "the process that ran it ended with exit code %d, twice",
                           WEXITSTATUS(status));
        }
        batch_case_lost(pool->plan, index, message, &row);
        good = record(pool, index, &row);
    }
    give_next(pool, worker);
    return good;
}

/** @return false to end the batch, with the reason in pool->error */
static bool attend(pool *pool, batch_worker *worker)
{
    batch_answer answer;
    const long index = worker->index;
    switch (batch_worker_hear(worker, &answer)) {
    case WORKER_SILENT:
        return true;
    case WORKER_GONE:
        return replace_worker(pool, worker);
    case WORKER_ANSWERED:
        break;
    }
    if (answer.is_lost) {
        *pool->error = answer.error;
        return false;
    }
    give_next(pool, worker); /* first: it works while its row is written */
    return record(pool, index, &answer.row);
}

static bool has_work(const pool *pool)
{
    for (int i = 0; i < pool->n_workers; i++) {
        if (pool->workers[i].index >= 0) {
            return true;
        }
    }
    return false;
}

static bool work(pool *pool)
{
    struct pollfd *ends = xcalloc((size_t)pool->n_workers, sizeof *ends);
    bool good = true;
    while (good && interrupt_signal == 0 && has_work(pool)) {
        for (int i = 0; i < pool->n_workers; i++) {
            ends[i] = (struct pollfd){.fd = pool->workers[i].socket, .events = POLLIN};
        }
        const int n = poll(ends, (nfds_t)pool->n_workers, LOOK_MILLISECONDS);
        for (int i = 0; i < pool->n_workers && n > 0 && good; i++) {
            good = ends[i].revents == 0 || attend(pool, &pool->workers[i]);
        }
        good = good && look_at_clock(pool);
    }
    free(ends);
    return good;
}

static bool start_all(pool *pool, int jobs)
{
    const int wanted = jobs < pool->state->n_todo ? jobs : (int)pool->state->n_todo;
    pool->workers = xcalloc((size_t)wanted, sizeof *pool->workers);
    for (pool->n_workers = 0; pool->n_workers < wanted; pool->n_workers++) {
        batch_worker *worker = &pool->workers[pool->n_workers];
        if (!start_worker(pool, worker)) {
            return false;
        }
        give_next(pool, worker);
    }
    return true;
}

void batch_pool_run(const batch_plan *plan, int jobs, bool show_progress, batch_state *state, evl_error *error)
{
    const double now = batch_clock();
    pool pool = {.plan = plan,
                 .state = state,
                 .error = error,
                 .started = now,
                 .synced = now,
                 .shown = now,
                 .show_progress = show_progress,
                 .is_terminal = isatty(STDERR_FILENO) == 1};
    const bool good = start_all(&pool, jobs) && work(&pool);
    const bool is_interrupted = good && has_work(&pool);
    for (int i = 0; i < pool.n_workers; i++) {
        (void)batch_worker_end(&pool.workers[i], !good || is_interrupted);
    }
    free(pool.workers);
    wipe_progress(&pool);
    if (good && sync_all(&pool) && is_interrupted) {
        evl_error_set(error, EVL_EXIT_INTERRUPTED, state->journal.path,
                      "interrupted by %s; %ld of %ld cases were finished, --resume runs the others",
                      interrupt_name((int)interrupt_signal), state->n_finished, state->n_todo);
    } else if (!good) {
        (void)fsync(state->journal.descriptor); /* the reason that ended the batch is worth more than that of a sync */
    }
}
