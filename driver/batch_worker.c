#include "batch_worker.h"

#include "memory.h"

#include <errno.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>
#ifdef __linux__
#include <sys/prctl.h>
#endif

/** What goes before the text of an answer. */
typedef struct {
    bool is_lost;
    journal_status status;
    size_t length;
} answer_head;

/* ---- in the worker ---- */

/** @return false at the end of the stream: the parent has no more work, or is gone */
static bool receive_index(int socket, long *index)
{
    char *to = (char *)index;
    size_t missing = sizeof *index;
    while (missing > 0) {
        const ssize_t n = recv(socket, to, missing, 0);
        if (n < 0 && errno == EINTR) {
            continue;
        }
        if (n <= 0) {
            return false;
        }
        to += n;
        missing -= (size_t)n;
    }
    return true;
}

static bool send_bytes(int socket, const void *bytes, size_t length)
{
    const char *from = bytes;
    while (length > 0) {
        const ssize_t n = send(socket, from, length, MSG_NOSIGNAL);
        if (n < 0 && errno == EINTR) {
            continue;
        }
        if (n <= 0) {
            return false;
        }
        from += n;
        length -= (size_t)n;
    }
    return true;
}

static bool send_answer(int socket, bool is_lost, journal_status status, const char *text, size_t length)
{
    const answer_head head = {.is_lost = is_lost, .status = status, .length = length};
    return send_bytes(socket, &head, sizeof head) && send_bytes(socket, text, length);
}

/** Only the parent decides when a job ends: it is told as well. */
static void leave_signals_to_parent(pid_t parent)
{
    static const int signals[] = {SIGINT, SIGTERM, SIGUSR1, SIGHUP};
    struct sigaction ignoring = {.sa_handler = SIG_IGN};
    (void)sigemptyset(&ignoring.sa_mask);
    for (size_t i = 0; i < sizeof signals / sizeof *signals; i++) {
        (void)sigaction(signals[i], &ignoring, NULL);
    }
#ifdef __linux__
    (void)prctl(PR_SET_PDEATHSIG, SIGKILL);
#endif
    if (getppid() != parent) {
        _exit(0); /* it died before that was set up */
    }
}

static void work(int socket, const batch_plan *plan)
{
    prepared_case prepared = {0};
    long index = 0;
    bool good = true;
    while (good && receive_index(socket, &index)) {
        batch_row row = {0};
        evl_error error;
        if (batch_case_run(plan, index, &prepared, &row, &error)) {
            good = send_answer(socket, false, row.status, row.line, row.length);
        } else {
            char *text = xasprintf("%s: %s", error.place, error.message);
            good = send_answer(socket, true, row.status, text, strlen(text));
            free(text);
        }
        free(row.line);
    }
    prepared_case_free(&prepared);
}

/* ---- in the parent ---- */

bool batch_worker_start(batch_worker *worker, const batch_plan *plan, const batch_worker *all, int n_all,
                        evl_error *error)
{
    int ends[2];
    const pid_t parent = getpid();
    if (socketpair(AF_UNIX, SOCK_STREAM, 0, ends) != 0) {
        evl_error_set(error, EVL_EXIT_INTERRUPTED, "", "cannot start a worker: %s; use fewer --jobs", strerror(errno));
        return false;
    }
    const pid_t pid = fork();
    if (pid < 0) {
        evl_error_set(error, EVL_EXIT_INTERRUPTED, "", "cannot start a worker: %s; use fewer --jobs", strerror(errno));
        (void)close(ends[0]);
        (void)close(ends[1]);
        return false;
    }
    if (pid == 0) {
        (void)close(ends[0]);
        for (int i = 0; i < n_all; i++) {
            if (all[i].pid != 0) {
                (void)close(all[i].socket);
            }
        }
        leave_signals_to_parent(parent);
        work(ends[1], plan);
        _exit(0);
    }
    (void)close(ends[1]);
    *worker = (batch_worker){.pid = pid, .socket = ends[0], .index = -1};
    return true;
}

void batch_worker_give(batch_worker *worker, long index, int n_tries)
{
    worker->index = index;
    worker->n_tries = n_tries;
    (void)send_bytes(worker->socket, &index, sizeof index);
}

/** A whole message in the buffer? Then hand its text over. */
static bool take_answer(batch_worker *worker, batch_answer *answer)
{
    answer_head head;
    if (worker->n_bytes < sizeof head) {
        return false;
    }
    memcpy(&head, worker->buffer, sizeof head);
    if (worker->n_bytes < sizeof head + head.length) {
        return false;
    }
    char *text = xcalloc(head.length + 1, 1);
    memcpy(text, worker->buffer + sizeof head, head.length);
    worker->n_bytes = 0; /* one case at a time: nothing follows an answer */
    worker->index = -1;
    *answer = (batch_answer){.is_lost = head.is_lost};
    if (head.is_lost) {
        evl_error_set(&answer->error, EVL_EXIT_IO, "", "%s", text);
        free(text);
    } else {
        answer->row = (batch_row){.status = head.status, .line = text, .length = head.length};
    }
    return true;
}

batch_worker_news batch_worker_hear(batch_worker *worker, batch_answer *answer)
{
    enum { PIECE = 64 * 1024 };
    for (;;) {
        if (worker->room - worker->n_bytes < PIECE) {
            worker->room += PIECE;
            worker->buffer = xrealloc(worker->buffer, worker->room, 1);
        }
        const ssize_t n = recv(worker->socket, worker->buffer + worker->n_bytes, PIECE, MSG_DONTWAIT);
        if (n < 0 && errno == EINTR) {
            continue;
        }
        if (n < 0 && (errno == EAGAIN || errno == EWOULDBLOCK)) {
            return WORKER_SILENT;
        }
        if (n <= 0) {
            return WORKER_GONE;
        }
        worker->n_bytes += (size_t)n;
        if (take_answer(worker, answer)) {
            return WORKER_ANSWERED;
        }
    }
}

int batch_worker_end(batch_worker *worker, bool kill_it)
{
    int status = 0;
    if (kill_it) {
        (void)kill(worker->pid, SIGKILL);
    }
    (void)close(worker->socket);
    while (waitpid(worker->pid, &status, 0) < 0 && errno == EINTR) {
    }
    free(worker->buffer);
    *worker = (batch_worker){.socket = -1, .index = -1};
    return status;
}
