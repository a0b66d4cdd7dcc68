#include "batch/batch_worker.h"

#include "base/memory.h"
#include "base/write_bytes.h"

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

/* ---- in the worker ---- */

/** Send the message and its text with one call: each wakes the parent. */
static bool send_reply(int socket, const batch_reply *reply)
{
    const size_t length = sizeof *reply + reply->row.length;
    CLEANUP_FREE char *message = xcalloc(length, 1);
    memcpy(message, reply, sizeof *reply);
    memcpy(message + sizeof *reply, reply->row.line, reply->row.length);
    return write_bytes(socket, -1, message, length) == length;
}

/** Only the parent, which receives the signals as well, decides when a job ends. If it has died, writing to it fails. */
static void leave_signals_to_parent(pid_t parent)
{
    static const int signals[] = {SIGINT, SIGTERM, SIGUSR1, SIGHUP, SIGPIPE};
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

/** @return false if the parent has died, or if the batch is stopped and the case has a checkpoint */
static bool run_case(const batch_work *work, long index, int socket, case_plan *of_case)
{
    evl_error error = {.code = EVL_EXIT_OK};
    batch_reply reply = {.index = index};
    const long n_wheels = wheel_store_computed(work->plan->wheels);
    if (!batch_case_run(work->plan, work->queue, work->todo[index], of_case, &reply.row, &error)) {
        reply.lost = error.code;
        free(reply.row.line);
        reply.row.line = evl_error_text(&error);
        reply.row.length = strlen(reply.row.line);
    }
    if (reply.row.line == NULL) {
        return false;
    }
    reply.n_wheels = wheel_store_computed(work->plan->wheels) - n_wheels;
    const bool good = send_reply(socket, &reply);
    free(reply.row.line);
    return good;
}

static void run_cases(const batch_work *work, int number, long first, int socket)
{
    case_plan of_case = {0};
    long index = first >= 0 ? first : batch_queue_take(work->queue, number);
    while (index >= 0 && run_case(work, index, socket, &of_case)) {
        index = batch_queue_take(work->queue, number);
    }
    case_plan_free(&of_case);
}

/* ---- in the parent ---- */

static bool fail_start(evl_error *error)
{
    return evl_error_set(error, EVL_EXIT_INTERRUPTED, "", "cannot start a worker: %s; use fewer --jobs",
                         strerror(errno));
}

bool batch_worker_start(batch_worker *worker, const batch_work *work, int number, long first, const batch_worker *all,
                        int n_all, evl_error *error)
{
    int ends[2];
    const pid_t parent = getpid();
    if (socketpair(AF_UNIX, SOCK_STREAM, 0, ends) != 0) {
        return fail_start(error);
    }
    const pid_t pid = fork();
    if (pid < 0) {
        (void)fail_start(error);
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
        run_cases(work, number, first, ends[1]);
        _exit(0);
    }
    (void)close(ends[1]);
    *worker = (batch_worker){.pid = pid, .socket = ends[0]};
    return true;
}

static int wait_for(pid_t pid)
{
    int status = 0;
    while (waitpid(pid, &status, 0) < 0 && errno == EINTR) {
    }
    return status;
}

/** If the buffer starts with a complete message, return its text. */
static bool take_reply(batch_worker *worker, batch_reply *reply)
{
    if (worker->n_bytes < sizeof *reply) {
        return false;
    }
    memcpy(reply, worker->buffer, sizeof *reply);
    const size_t length = sizeof *reply + reply->row.length;
    if (worker->n_bytes < length) {
        return false;
    }
    reply->row.line = xcalloc(reply->row.length + 1, 1);
    memcpy(reply->row.line, worker->buffer + sizeof *reply, reply->row.length);
    worker->n_bytes -= length;
    memmove(worker->buffer, worker->buffer + length, worker->n_bytes);
    return true;
}

batch_worker_news batch_worker_hear(batch_worker *worker, batch_reply *reply)
{
    enum { PIECE = 64 * 1024 };
    while (!take_reply(worker, reply)) {
        if (worker->capacity - worker->n_bytes < PIECE) {
            worker->capacity += PIECE;
            worker->buffer = xrealloc(worker->buffer, worker->capacity, 1);
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
    }
    return WORKER_REPLIED;
}

void batch_worker_kill(batch_worker *worker)
{
    (void)kill(worker->pid, SIGKILL);
    worker->wait_status = wait_for(worker->pid);
    worker->is_over = true;
}

int batch_worker_end(batch_worker *worker)
{
    const int status = worker->is_over ? worker->wait_status : wait_for(worker->pid);
    (void)close(worker->socket);
    free(worker->buffer);
    *worker = (batch_worker){.socket = -1};
    return status;
}
