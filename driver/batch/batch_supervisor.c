#include "batch/batch_supervisor.h"

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

typedef struct supervisor {
    memory_arena memory; /**< owns the arrays */
    batch_work work;     /**< its list is that of the state; cases that are not recorded remain in it */
    batch_state *state;
    evl_error *error;
    int n_workers;
    batch_worker *workers;
    long n_left;                        /**< length of the list */
    tries *tries;                       /**< [n_left] */
    long n_bad;                         /**< failed or refused in this run */
    long n_checkpointed, *checkpointed; /**< recorded cases with checkpoints since the last synchronisation */
    double started, synced, shown;
    bool show_progress, is_terminal;
    double progress_interval; /**< [s] between two lines of progress */
} supervisor;

/* ---- progress and synchronisation ---- */

static void show_progress(const supervisor *supervisor, double now)
{
    const batch_state *state = supervisor->state;
    const double rate = (double)state->n_finished / (now - supervisor->started);
    char left[32], text[200];
    progress_left(left, rate > 0.0 ? (double)(state->n_todo - state->n_finished) / rate : INFINITY);
    (void)snprintf(text, sizeof text, "%ld of %ld done, %ld of them did not finish, %.3g a second%s", state->n_finished,
                   state->n_todo, supervisor->n_bad, rate, left);
    progress_show(supervisor->is_terminal, text);
}

static void wipe_progress(const supervisor *supervisor)
{
    if (supervisor->is_terminal && supervisor->show_progress) {
        progress_wipe();
    }
}

/** Synchronise histories first: a recorded row has its history on disk. @return false if the disk fails */
static bool sync_all(supervisor *supervisor)
{
    const stack *stack = &supervisor->work.plan->stack;
    journal *journal = &supervisor->state->journal;
    if (!journal->is_dirty) {
        return true;
    }
    if ((stack->descriptor >= 0 && !stack_sync(stack, supervisor->error)) ||
        !journal_sync(journal, supervisor->error)) {
        return false;
    }
    while (supervisor->n_checkpointed > 0) {
        batch_checkpoints_remove(&supervisor->work.plan->checkpoints,
                                 supervisor->checkpointed[--supervisor->n_checkpointed]);
    }
    return true;
}

static bool look_at_clock(supervisor *supervisor)
{
    const double now = clock_seconds();
    const bool is_shown = supervisor->show_progress && now - supervisor->shown >= supervisor->progress_interval;
    if (is_shown || now - supervisor->synced >= sync_interval) {
        supervisor->synced = now;
        if (!sync_all(supervisor)) {
            return false;
        }
    }
    if (is_shown) { /* cases reported as done are on the disk */
        show_progress(supervisor, now);
        supervisor->shown = now;
    }
    return true;
}

/* ---- rows ---- */

/** Note a recorded case whose checkpoints are no longer needed. */
static void note_checkpointed(supervisor *supervisor, bool has_some, long index)
{
    if (has_some) {
        supervisor->checkpointed =
            arena_grow(&supervisor->memory, supervisor->checkpointed, (size_t)supervisor->n_checkpointed,
                       (size_t)supervisor->n_checkpointed + 1, sizeof *supervisor->checkpointed);
        supervisor->checkpointed[supervisor->n_checkpointed++] = index;
    }
}

static bool record(supervisor *supervisor, long index, batch_row *row)
{
    const bool good = journal_append(&supervisor->state->journal, row->line, row->length, supervisor->error);
    if (good) {
        supervisor->state->cases[supervisor->work.todo[index]].status = row->status;
        supervisor->state->n_finished++;
        supervisor->n_bad += row->status == JOURNAL_DONE ? 0 : 1;
        supervisor->tries[index].n_deaths = -1;
        note_checkpointed(supervisor, row->has_checkpoints, supervisor->work.todo[index]);
    }
    free(row->line);
    return good;
}

static bool record_lost(supervisor *supervisor, long index, int wait_status)
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
    batch_case_lost(supervisor->work.plan, supervisor->work.todo[index], message, &row);
    row.has_checkpoints = true; /* possibly */
    return record(supervisor, index, &row);
}

/* ---- workers ---- */

static bool start_worker(supervisor *supervisor, int number, long first)
{
    return batch_worker_start(&supervisor->workers[number], &supervisor->work, number, first, supervisor->workers,
                              supervisor->n_workers, supervisor->error);
}

/** A process of a case has died again. @return whether to give up the case: the first death may have any cause; the
 *  second is attributed to the case, unless it made progress in between. */
static bool is_abandoned(supervisor *supervisor, long index)
{
    tries *tries = &supervisor->tries[index];
    const double reach = batch_checkpoints_reach(&supervisor->work.plan->checkpoints, supervisor->work.todo[index]);
    tries->n_deaths = reach > tries->reach ? 1 : tries->n_deaths + 1;
    tries->reach = fmax(reach, tries->reach);
    return tries->n_deaths == MOST_TRIES;
}

/** A worker has ended: because there is nothing left to do, or during a case. */
static bool replace_worker(supervisor *supervisor, int number)
{
    const long index = batch_queue_last(supervisor->work.queue, number);
    const int status = batch_worker_end(&supervisor->workers[number]);
    const bool in_case = index >= 0 && supervisor->tries[index].n_deaths >= 0;
    if (!in_case && WIFEXITED(status) && WEXITSTATUS(status) == 0) {
        return true;
    }
    if (in_case && is_abandoned(supervisor, index)) {
        return record_lost(supervisor, index, status) && start_worker(supervisor, number, -1);
    }
    return start_worker(supervisor, number, in_case ? index : -1);
}

/** Record all messages of a worker. @return false to end the batch, with the reason in supervisor->error */
static bool attend(supervisor *supervisor, int number, batch_worker_news *news)
{
    batch_reply reply;
    bool good = true;
    while (good && (*news = batch_worker_hear(&supervisor->workers[number], &reply)) == WORKER_REPLIED) {
        supervisor->state->n_wheels += reply.n_wheels;
        if (reply.lost != EVL_EXIT_OK) {
            CLEANUP_FREE char *reason = reply.row.line;
            return evl_error_set(supervisor->error, reply.lost, "", "%s", reason);
        }
        good = record(supervisor, reply.index, &reply.row);
    }
    return good;
}

static bool has_workers(const supervisor *supervisor)
{
    for (int i = 0; i < supervisor->n_workers; i++) {
        if (supervisor->workers[i].pid != 0) {
            return true;
        }
    }
    return false;
}

/** Record messages of all workers, for a moment. @param gone  called for a worker that has ended */
static bool listen(supervisor *supervisor, bool (*gone)(struct supervisor *supervisor, int number))
{
    CLEANUP_FREE struct pollfd *ends = xcalloc((size_t)supervisor->n_workers, sizeof *ends);
    bool good = true;
    for (int i = 0; i < supervisor->n_workers; i++) {
        ends[i] = (struct pollfd){.fd = supervisor->workers[i].socket, .events = POLLIN};
    }
    const int n = poll(ends, (nfds_t)supervisor->n_workers, LOOK_MILLISECONDS);
    for (int i = 0; i < supervisor->n_workers && n > 0 && good; i++) {
        batch_worker_news news = WORKER_SILENT;
        good = ends[i].revents == 0 || attend(supervisor, i, &news);
        good = good && (news != WORKER_GONE || gone(supervisor, i));
    }
    good = good && look_at_clock(supervisor);
    if (good && n > 0 && has_workers(supervisor)) {
        (void)nanosleep(&rest, NULL);
    }
    return good;
}

/** Record messages until all workers have ended. */
static bool listen_to_all(supervisor *supervisor)
{
    bool good = true;
    while (good && interrupt_signal == 0 && has_workers(supervisor)) {
        good = listen(supervisor, replace_worker);
    }
    return good;
}

static bool start_all(supervisor *supervisor)
{
    bool good = true;
    batch_queue_restart(supervisor->work.queue, supervisor->n_left);
    for (int i = 0; i < supervisor->n_workers && good; i++) {
        good = start_worker(supervisor, i, -1);
    }
    return good;
}

static bool end_worker(supervisor *supervisor, int number)
{
    (void)batch_worker_end(&supervisor->workers[number]);
    return true;
}

/** Stop the remaining workers, after a signal so that they write checkpoints. `good`: their data can be written to the
 *  disk. */
static bool stop_all(supervisor *supervisor, bool good)
{
    const double end = clock_seconds() + patience;
    batch_queue_stop(supervisor->work.queue);
    while (good && has_workers(supervisor) && clock_seconds() < end) {
        good = listen(supervisor, end_worker);
    }
    for (int i = 0; i < supervisor->n_workers; i++) {
        if (supervisor->workers[i].pid != 0) {
            batch_worker_news news;
            batch_worker_kill(&supervisor->workers[i]);
            good = good && attend(supervisor, i, &news);
            (void)batch_worker_end(&supervisor->workers[i]);
        }
    }
    return good;
}

/* ---- complete run ---- */

static bool begin(supervisor *supervisor, int jobs)
{
    const long n = supervisor->state->n_todo;
    supervisor->n_workers = jobs < n ? jobs : (int)n;
    supervisor->workers = arena_calloc(&supervisor->memory, (size_t)supervisor->n_workers, sizeof *supervisor->workers);
    for (int i = 0; i < supervisor->n_workers; i++) {
        supervisor->workers[i].socket = -1;
    }
    supervisor->n_left = n;
    supervisor->tries = arena_calloc(&supervisor->memory, (size_t)n, sizeof *supervisor->tries);
    for (long i = 0; i < n; i++) {
        supervisor->tries[i].reach = -INFINITY;
    }
    supervisor->work.todo = supervisor->state->todo;
    supervisor->work.queue = batch_queue_create(n, supervisor->n_workers);
    if (supervisor->work.queue == NULL) {
        evl_error_set(supervisor->error, EVL_EXIT_INTERRUPTED, "", "cannot share memory with the workers: %s",
                      strerror(errno));
    }
    return supervisor->work.queue != NULL;
}

/** Retain only unrecorded cases in the list: all if the run was interrupted; else a case that a worker was just taking
 *  when it died, if any. */
static void retain_unrecorded(supervisor *supervisor)
{
    long n = 0;
    for (long i = 0; i < supervisor->n_left; i++) {
        if (supervisor->tries[i].n_deaths >= 0) {
            supervisor->state->todo[n] = supervisor->state->todo[i];
            supervisor->tries[n++] = supervisor->tries[i];
        }
    }
    supervisor->n_left = n;
}

void batch_supervisor_run(const batch_plan *plan, int jobs, bool show_progress, batch_state *state, evl_error *error)
{
    const double now = clock_seconds();
    const bool is_terminal = progress_is_on_terminal();
    supervisor supervisor = {.work = {.plan = plan},
                             .state = state,
                             .error = error,
                             .started = now,
                             .synced = now,
                             .shown = now,
                             .show_progress = show_progress,
                             .is_terminal = is_terminal,
                             .progress_interval = is_terminal ? terminal_interval : progress_log_interval()};
    bool good = begin(&supervisor, jobs);
    while (good && supervisor.n_left > 0 && interrupt_signal == 0) {
        good = start_all(&supervisor) && listen_to_all(&supervisor);
        good = stop_all(&supervisor, good);
        retain_unrecorded(&supervisor);
    }
    wipe_progress(&supervisor);
    if (good && sync_all(&supervisor) && supervisor.n_left > 0) {
        evl_error_set(error, EVL_EXIT_INTERRUPTED, state->journal.path,
                      "interrupted by %s; %ld of %ld cases were finished, --resume runs the others",
                      interrupt_name((int)interrupt_signal), state->n_finished, state->n_todo);
    } else if (!good) {
        (void)fsync(state->journal.descriptor); /* the reason that ended the batch has priority over that of a failed
                                                 * synchronisation */
    }
    batch_queue_delete(&supervisor.work.queue);
    arena_free(&supervisor.memory);
}
