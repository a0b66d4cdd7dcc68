#include "batch/batch_pool.h"

#include "base/interrupt.h"
#include "base/log.h"
#include "base/memory.h"
#include "base/progress.h"
#include "batch/batch_worker.h"

#include <errno.h>
#include <math.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

enum { MOST_TRIES = 2, LOOK_MILLISECONDS = 200 };
static const struct timespec rest = {
    .tv_nsec = 10000000};                    /* between two polls of the workers: each poll costs the workers time */
static const double patience = 10.0;         /* [s] for workers to write checkpoints when the batch is stopped */
static const double sync_interval = 1.0;     /* [s] between two synchronisations to the disk */
static const double terminal_interval = 1.0; /* [s] between two lines of progress on a terminal */

/** Processes that ran a case. */
typedef struct {
    int n_deaths; /**< number of processes that died without progress beyond the previous one; -1: the case is recorded */
    double reach; /**< model time of the checkpoint from which the next one resumes [s] */
} tries;

typedef struct pool {
    memory_pool memory; /**< owns the arrays */
    batch_work work;    /**< its list is that of the state; cases that are not recorded remain in it */
    batch_state *state;
    evl_error *error;
    int n_workers;
    batch_worker *workers;
    long n_left;        /**< length of the list */
    tries *tries;       /**< [n_left] */
    long n_bad;         /**< failed or refused in this run */
    long n_kept, *kept; /**< recorded cases with checkpoints since the last synchronisation */
    double started, synced, shown;
    bool show_progress, is_terminal;
    double progress_interval; /**< [s] between two lines of progress */
} pool;

/* ---- progress and synchronisation ---- */

static void show_progress(const pool *pool, double now)
{
    const batch_state *state = pool->state;
    const double rate = (double)state->n_finished / (now - pool->started);
    char left[32], text[200];
    progress_left(left, rate > 0.0 ? (double)(state->n_todo - state->n_finished) / rate : INFINITY);
    (void)snprintf(text, sizeof text, "%ld of %ld done, %ld of them did not finish, %.3g a second%s", state->n_finished,
                   state->n_todo, pool->n_bad, rate, left);
    progress_show(pool->is_terminal, text);
}

static void wipe_progress(const pool *pool)
{
    if (pool->is_terminal && pool->show_progress) {
        progress_wipe();
    }
}

/** Synchronise histories first: a recorded row has its history on disk. @return false if the disk fails */
static bool sync_all(pool *pool)
{
    const stack *stack = &pool->work.plan->stack;
    journal *journal = &pool->state->journal;
    if (!journal->is_dirty) {
        return true;
    }
    if ((stack->descriptor >= 0 && !stack_sync(stack, pool->error)) || !journal_sync(journal, pool->error)) {
        return false;
    }
    while (pool->n_kept > 0) {
        batch_checkpoints_remove(&pool->work.plan->checkpoints, pool->kept[--pool->n_kept]);
    }
    return true;
}

static bool look_at_clock(pool *pool)
{
    const double now = clock_seconds();
    const bool is_shown = pool->show_progress && now - pool->shown >= pool->progress_interval;
    if (is_shown || now - pool->synced >= sync_interval) {
        pool->synced = now;
        if (!sync_all(pool)) {
            return false;
        }
    }
    if (is_shown) { /* cases reported as done are on the disk */
        show_progress(pool, now);
        pool->shown = now;
    }
    return true;
}

/* ---- rows ---- */

/** Note a recorded case whose checkpoints are no longer needed. */
static void note_kept(pool *pool, bool has_some, long index)
{
    if (has_some) {
        pool->kept =
            pool_grow(&pool->memory, pool->kept, (size_t)pool->n_kept, (size_t)pool->n_kept + 1, sizeof *pool->kept);
        pool->kept[pool->n_kept++] = index;
    }
}

static bool record(pool *pool, long place, batch_row *row)
{
    const bool good = journal_append(&pool->state->journal, row->line, row->length, pool->error);
    if (good) {
        pool->state->cases[pool->work.todo[place]].status = row->status;
        pool->state->n_finished++;
        pool->n_bad += row->status == JOURNAL_DONE ? 0 : 1;
        pool->tries[place].n_deaths = -1;
        note_kept(pool, row->has_checkpoints, pool->work.todo[place]);
    }
    free(row->line);
    return good;
}

static bool record_lost(pool *pool, long place, int wait_status)
{
    char message[128];
    batch_row row;
    if (WIFSIGNALED(wait_status)) {
        (void)snprintf(message, sizeof message, "the process that ran it was ended by signal %d (%s), twice",
                       WTERMSIG(wait_status), strsignal(WTERMSIG(wait_status)));
    } else {
        (void)snprintf(message, sizeof message, "the process that ran it ended with exit code %d, twice",
                       WEXITSTATUS(wait_status));
    }
    batch_case_lost(pool->work.plan, pool->work.todo[place], message, &row);
    row.has_checkpoints = true; /* possibly */
    return record(pool, place, &row);
}

/* ---- workers ---- */

static bool start_worker(pool *pool, int number, long first)
{
    return batch_worker_start(&pool->workers[number], &pool->work, number, first, pool->workers, pool->n_workers,
                              pool->error);
}

/** A process of a case has died again. @return whether to give up the case: the first death may have any cause; the
 *  second is attributed to the case, unless it made progress in between. */
static bool is_given_up(pool *pool, long place)
{
    tries *tries = &pool->tries[place];
    const double reach = batch_checkpoints_reach(&pool->work.plan->checkpoints, pool->work.todo[place]);
    tries->n_deaths = reach > tries->reach ? 1 : tries->n_deaths + 1;
    tries->reach = fmax(reach, tries->reach);
    return tries->n_deaths == MOST_TRIES;
}

/** A worker has ended: because there is nothing left to do, or during a case. */
static bool replace_worker(pool *pool, int number)
{
    const long place = batch_queue_last(pool->work.queue, number);
    const int status = batch_worker_end(&pool->workers[number]);
    const bool in_case = place >= 0 && pool->tries[place].n_deaths >= 0;
    if (!in_case && WIFEXITED(status) && WEXITSTATUS(status) == 0) {
        return true;
    }
    if (in_case && is_given_up(pool, place)) {
        return record_lost(pool, place, status) && start_worker(pool, number, -1);
    }
    return start_worker(pool, number, in_case ? place : -1);
}

/** Record all messages of a worker. @return false to end the batch, with the reason in pool->error */
static bool attend(pool *pool, int number, batch_worker_news *news)
{
    batch_answer answer;
    bool good = true;
    while (good && (*news = batch_worker_hear(&pool->workers[number], &answer)) == WORKER_ANSWERED) {
        pool->state->n_wheels += answer.n_wheels;
        if (answer.lost != EVL_EXIT_OK) {
            OWNED char *reason = answer.row.line;
            return evl_error_set(pool->error, answer.lost, "", "%s", reason);
        }
        good = record(pool, answer.place, &answer.row);
    }
    return good;
}

static bool has_workers(const pool *pool)
{
    for (int i = 0; i < pool->n_workers; i++) {
        if (pool->workers[i].pid != 0) {
            return true;
        }
    }
    return false;
}

/** Record messages of all workers, for a moment. @param gone  called for a worker that has ended */
static bool listen(pool *pool, bool (*gone)(struct pool *pool, int number))
{
    OWNED struct pollfd *ends = xcalloc((size_t)pool->n_workers, sizeof *ends);
    bool good = true;
    for (int i = 0; i < pool->n_workers; i++) {
        ends[i] = (struct pollfd){.fd = pool->workers[i].socket, .events = POLLIN};
    }
    const int n = poll(ends, (nfds_t)pool->n_workers, LOOK_MILLISECONDS);
    for (int i = 0; i < pool->n_workers && n > 0 && good; i++) {
        batch_worker_news news = WORKER_SILENT;
        good = ends[i].revents == 0 || attend(pool, i, &news);
        good = good && (news != WORKER_GONE || gone(pool, i));
    }
    good = good && look_at_clock(pool);
    if (good && n > 0 && has_workers(pool)) {
        (void)nanosleep(&rest, NULL);
    }
    return good;
}

/** Record messages until all workers have ended. */
static bool listen_to_all(pool *pool)
{
    bool good = true;
    while (good && interrupt_signal == 0 && has_workers(pool)) {
        good = listen(pool, replace_worker);
    }
    return good;
}

static bool start_all(pool *pool)
{
    bool good = true;
    batch_queue_restart(pool->work.queue, pool->n_left);
    for (int i = 0; i < pool->n_workers && good; i++) {
        good = start_worker(pool, i, -1);
    }
    return good;
}

static bool end_worker(pool *pool, int number)
{
    (void)batch_worker_end(&pool->workers[number]);
    return true;
}

/** Stop the remaining workers, after a signal so that they write checkpoints. `good`: their data can be written to the
 *  disk. */
static bool stop_all(pool *pool, bool good)
{
    const double end = clock_seconds() + patience;
    batch_queue_stop(pool->work.queue);
    while (good && has_workers(pool) && clock_seconds() < end) {
        good = listen(pool, end_worker);
    }
    for (int i = 0; i < pool->n_workers; i++) {
        if (pool->workers[i].pid != 0) {
            batch_worker_news news;
            batch_worker_kill(&pool->workers[i]);
            good = good && attend(pool, i, &news);
            (void)batch_worker_end(&pool->workers[i]);
        }
    }
    return good;
}

/* ---- complete run ---- */

static bool begin(pool *pool, int jobs)
{
    const long n = pool->state->n_todo;
    pool->n_workers = jobs < n ? jobs : (int)n;
    pool->workers = pool_calloc(&pool->memory, (size_t)pool->n_workers, sizeof *pool->workers);
    for (int i = 0; i < pool->n_workers; i++) {
        pool->workers[i].socket = -1;
    }
    pool->n_left = n;
    pool->tries = pool_calloc(&pool->memory, (size_t)n, sizeof *pool->tries);
    for (long i = 0; i < n; i++) {
        pool->tries[i].reach = -INFINITY;
    }
    pool->work.todo = pool->state->todo;
    pool->work.queue = batch_queue_create(n, pool->n_workers);
    if (pool->work.queue == NULL) {
        evl_error_set(pool->error, EVL_EXIT_INTERRUPTED, "", "cannot share memory with the workers: %s",
                      strerror(errno));
    }
    return pool->work.queue != NULL;
}

/** Retain only unrecorded cases in the list: all if the run was interrupted; else a case that a worker was just taking
 *  when it died, if any. */
static void keep_unrecorded(pool *pool)
{
    long n = 0;
    for (long i = 0; i < pool->n_left; i++) {
        if (pool->tries[i].n_deaths >= 0) {
            pool->state->todo[n] = pool->state->todo[i];
            pool->tries[n++] = pool->tries[i];
        }
    }
    pool->n_left = n;
}

void batch_pool_run(const batch_plan *plan, int jobs, bool show_progress, batch_state *state, evl_error *error)
{
    const double now = clock_seconds();
    const bool is_terminal = progress_is_on_terminal();
    pool pool = {.work = {.plan = plan},
                 .state = state,
                 .error = error,
                 .started = now,
                 .synced = now,
                 .shown = now,
                 .show_progress = show_progress,
                 .is_terminal = is_terminal,
                 .progress_interval = is_terminal ? terminal_interval : progress_log_interval()};
    bool good = begin(&pool, jobs);
    while (good && pool.n_left > 0 && interrupt_signal == 0) {
        good = start_all(&pool) && listen_to_all(&pool);
        good = stop_all(&pool, good);
        keep_unrecorded(&pool);
    }
    wipe_progress(&pool);
    if (good && sync_all(&pool) && pool.n_left > 0) {
        evl_error_set(error, EVL_EXIT_INTERRUPTED, state->journal.path,
                      "interrupted by %s; %ld of %ld cases were finished, --resume runs the others",
                      interrupt_name((int)interrupt_signal), state->n_finished, state->n_todo);
    } else if (!good) {
        (void)fsync(state->journal.descriptor); /* the reason that ended the batch has priority over that of a failed
                                                 * synchronisation */
    }
    batch_queue_delete(&pool.work.queue);
    pool_free(&pool.memory);
}
