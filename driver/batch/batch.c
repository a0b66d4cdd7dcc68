#include "batch/batch.h"

#include "base/lock.h"
#include "base/log.h"
#include "base/memory.h"
#include "base/progress.h"
#include "base/write_bytes.h"
#include "batch/batch_check.h"
#include "batch/batch_response.h"
#include "batch/batch_supervisor.h"
#include "batch/batch_todo.h"
#include "batch/batch_warnings.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/types.h>
#include <unistd.h>
#ifdef __linux__
#include <sys/prctl.h>
#endif

enum { MOST_JOBS = 1024, MOST_SHARDS = 1000000 };

typedef struct {
    int shard, n_shards, jobs;
    double checkpoint_interval; /**< [s] */
} batch_share;

/* ---- the command line ---- */

/** Read a count from 1 on at the start of a text. @return the rest of the text, NULL if there is no such count */
static const char *read_count(const char *text, int most, int *count)
{
    char *end = NULL;
    errno = 0;
    const long value = strtol(text, &end, 10);
    if (end == text || text[0] < '0' || text[0] > '9' || errno != 0 || value < 1 || value > most) {
        return NULL;
    }
    *count = (int)value;
    return end;
}

static bool read_share(const batch_options *options, batch_share *share, evl_error *error)
{
    *share = (batch_share){.shard = 1, .n_shards = 1, .jobs = 1};
    if (options->shard != NULL) {
        const char *rest = read_count(options->shard, MOST_SHARDS, &share->shard);
        rest = rest != NULL && rest[0] == '/' ? read_count(rest + 1, MOST_SHARDS, &share->n_shards) : NULL;
        if (rest == NULL || rest[0] != '\0' || share->shard > share->n_shards) {
            return evl_error_set(error, EVL_EXIT_USAGE, "", "--shard %s: write I/N, the shard I of N, from 1/N to N/N",
                                 options->shard);
        }
    }
    if (options->jobs != NULL) {
        const char *rest = read_count(options->jobs, MOST_JOBS, &share->jobs);
        if (rest == NULL || rest[0] != '\0') {
            return evl_error_set(error, EVL_EXIT_USAGE, "", "--jobs %s: write a number of processes from 1 to %d",
                                 options->jobs, MOST_JOBS);
        }
    }
    return batch_checkpoints_read(options->checkpoint, &share->checkpoint_interval) ||
           evl_error_set(error, EVL_EXIT_USAGE, "", "--checkpoint %s: write minutes, or 0 for no checkpoints",
                         options->checkpoint);
}

/* ---- the folder ---- */

/** Read the first line of a file, without its newline; NULL, with errno, if it cannot be read. */
static char *read_line(const char *path)
{
    FILE *file = fopen(path, "rb");
    if (file == NULL) {
        return NULL;
    }
    char *line = NULL;
    size_t capacity = 0;
    const ssize_t length = getline(&line, &capacity, file);
    const int reason = errno;
    const bool was_read = length >= 0 || feof(file) != 0; /* a failed allocation is not an empty file */
    (void)fclose(file);
    char *text = length >= 0 ? xasprintf("%.*s", (int)strcspn(line, "\n"), line) : was_read ? xstrdup("") : NULL;
    free(line);
    errno = reason;
    return text;
}

/** Write the mark under a temporary name first: shards that start at the same time see all of it or nothing. */
static bool mark_folder(const char *mark, const char *hash, evl_error *error)
{
    CLEANUP_FREE char *partial = xasprintf("%s.%ld", mark, (long)getpid()), *line = xasprintf("%s\n", hash);
    const size_t length = strlen(line);
    (void)unlink(partial); /* left by a killed process with the same id; or a link, which is not followed */
    const int descriptor = open(partial, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    bool good = descriptor >= 0 && write_bytes(descriptor, -1, line, length) == length && sync_bytes(descriptor);
    const int reason = errno;
    const bool is_closed = descriptor < 0 || close(descriptor) == 0;
    errno = good ? errno : reason;
    good = good && is_closed;
    good = (good && (link(partial, mark) == 0 || errno == EEXIST || rename(partial, mark) == 0)) ||
           evl_error_set_unwritten(error, mark);
    (void)unlink(partial);
    return good;
}

/** Reserve a folder for the results of one design. */
static bool claim_folder(const char *folder, const char *hash, evl_error *error)
{
    if (mkdir(folder, 0777) != 0 && errno != EEXIST) {
        return evl_error_set_unwritten(error, folder);
    }
    CLEANUP_FREE char *mark = xasprintf("%s/design.txt", folder), *found = read_line(mark);
    if (found == NULL && errno == ENOENT) {
        if (!mark_folder(mark, hash, error)) {
            return false;
        }
        found = read_line(mark);
    }
    if (found == NULL) {
        return evl_error_set_unwritten(error, mark);
    }
    return strcmp(found, hash) == 0 ||
           evl_error_set(error, EVL_EXIT_CASE, mark,
                         "this folder holds the results of another design (%.16s..., not %.16s...); choose another "
                         "folder",
                         found, hash);
}

/* ---- the shard ---- */

typedef struct {
    const batch_options *options;
    batch_share share;
    design *design;
    batch_plan plan;
    batch_state state;
    const char *stem; /**< FOLDER/shard-I-of-N */
    long n_recorded;  /**< cases recorded by earlier runs */
} shard_run;

static bool open_histories(shard_run *run, evl_error *error)
{
    const batch_histories *histories = &run->plan.histories;
    if (histories->n_variables == 0) {
        return true;
    }
    CLEANUP_FREE char *path = xasprintf("%s.h5", run->stem);
    if (run->n_recorded > 0 && access(path, F_OK) != 0) {
        log_warning("%sis missing, and with it the histories of the %ld cases already recorded", path, run->n_recorded);
    }
    const stack_layout layout = {.path = path,
                                 .hash = run->design->hash,
                                 .first_case = run->plan.first_case,
                                 .stride = run->plan.stride,
                                 .n_rows = batch_shard_size(&run->plan),
                                 .axis = histories->axis.coordinate,
                                 .n_variables = histories->n_variables,
                                 .variables = histories->variables,
                                 .names = &model_about(histories->first.model)->names};
    return stack_open(&run->plan.stack, &layout, error);
}

static bool open_journal(shard_run *run, evl_error *error)
{
    batch_state *state = &run->state;
    CLEANUP_FREE char *path = xasprintf("%s.jsonl", run->stem);
    CLEANUP_FREE char *head = batch_plan_head(&run->plan, run->share.shard, run->share.n_shards);
    state->cases = xcalloc((size_t)run->design->n_cases, sizeof *state->cases);
    if (!journal_open(&state->journal, path, head, run->design->n_cases, state->cases, &run->n_recorded, error)) {
        return false;
    }
    return run->n_recorded == 0 || run->options->resume || run->options->cases != NULL ||
           evl_error_set(error, EVL_EXIT_CASE, path,
                         "%ld cases are already recorded here; continue with --resume, or choose another folder",
                         run->n_recorded);
}

/** A row is recorded only after the names of its files are on disk, in spite of power failures: of the journal, the
 *  histories and the folder itself. */
static bool sync_names(const shard_run *run, evl_error *error)
{
    return (sync_name(run->stem) && sync_name(run->options->folder)) ||
           evl_error_set_unwritten(error, run->options->folder);
}

/** Delete the checkpoints of recorded cases, after the records are on the disk. */
static bool drop_checkpoints(shard_run *run, evl_error *error)
{
    const batch_state *state = &run->state;
    if (access(run->plan.checkpoints.folder, F_OK) == 0) {
        if (!journal_sync(&run->state.journal, error)) {
            return false;
        }
        batch_checkpoints_retain(&run->plan.checkpoints, state->n_todo, state->todo);
    }
    return true;
}

/** @return whether some cases did not finish */
static bool summarise(const shard_run *run, double seconds)
{
    const long n = batch_shard_size(&run->plan);
    long counts[JOURNAL_REFUSED + 1] = {0};
    for (long i = 0; i < n; i++) {
        counts[run->state.cases[run->plan.first_case + i * run->plan.stride].status]++;
    }
    const long bad = counts[JOURNAL_FAILED] + counts[JOURNAL_REFUSED];
    const long n_wheels = run->state.n_wheels + wheel_store_computed(run->plan.wheels);
    CLEANUP_FREE char *wheels =
        n_wheels == 0 ? xstrdup("") : xasprintf(", compliances of wheels computed: %ld", n_wheels);
    log_note("shard %d of %d: %ld cases, %ld done, %ld did not finish (%ld failed, %ld refused); %ld of them now, in "
             "%.3g s%s: %s.jsonl",
             run->share.shard, run->share.n_shards, n, counts[JOURNAL_DONE], bad, counts[JOURNAL_FAILED],
             counts[JOURNAL_REFUSED], run->state.n_finished, seconds, wheels, run->stem);
    return bad > 0;
}

/** Run with the lock held. @return as summarise */
static bool run_locked(shard_run *run, evl_error *error)
{
    batch_state *state = &run->state;
    bool is_partial = false;
    if (open_journal(run, error) &&
        batch_todo(&run->plan, run->options->cases, state->cases, &state->todo, &state->n_todo, error) &&
        (state->n_todo == 0 ||
         (open_histories(run, error) && batch_response_folder(&run->plan, error) && sync_names(run, error))) &&
        drop_checkpoints(run, error)) {
        const double start = clock_seconds();
        batch_response_retain(&run->plan, state->n_todo, state->todo);
        batch_supervisor_run(&run->plan, run->share.jobs, !run->options->quiet, state, error);
        is_partial = error->code == EVL_EXIT_OK && summarise(run, clock_seconds() - start);
    }
    free(state->todo);
    free(state->cases);
    journal_close(&state->journal);
    return is_partial;
}

static bool run_shard(shard_run *run, evl_error *error)
{
    file_lock lock;
    bool is_partial = false;
    run->state.journal.descriptor = -1;
    CLEANUP_FREE char *stem =
        xasprintf("%s/shard-%d-of-%d", run->options->folder, run->share.shard, run->share.n_shards);
    CLEANUP_FREE char *responses = xasprintf("%s/responses", run->options->folder);
    CLEANUP_FREE char *lock_path = xasprintf("%s.lock", stem), *checkpoints = xasprintf("%s.checkpoints", stem);
    run->stem = stem;
    run->plan.responses = responses;
    run->plan.checkpoints = (batch_checkpoints){checkpoints, run->share.checkpoint_interval};
    if (claim_folder(run->options->folder, run->design->hash, error) &&
        wheel_store_share(run->plan.wheels, run->options->folder, error) && file_lock_take(&lock, lock_path, error)) {
        is_partial = run_locked(run, error);
        file_lock_release(&lock);
    }
    return is_partial;
}

/** If the environment variable EVOLVENT_PARENT names a process, receive SIGTERM when the parent process ends, on
 *  systems that support it (Linux). An orphaned job would hold its lock and continue to write.
 *  @return false with the reason in `error`, EVL_EXIT_INTERRUPTED: the named process no longer exists */
static bool follow_parent(evl_error *error)
{
    const char *named = getenv("EVOLVENT_PARENT");
    const long pid = named == NULL ? 0 : strtol(named, NULL, 10);
    if (pid <= 1) {
        return true;
    }
#ifdef __linux__
    (void)prctl(PR_SET_PDEATHSIG, SIGTERM);
#endif
    if (kill((pid_t)pid, 0) != 0 && errno == ESRCH) {
        return evl_error_set(error, EVL_EXIT_INTERRUPTED, "", "its parent process, %ld, has ended", pid);
    }
    return true;
}

evl_exit batch(const char *design, const batch_options *options, evl_error *error)
{
    shard_run run = {.options = options};
    bool is_partial = false;
    if (follow_parent(error) && read_share(options, &run.share, error) &&
        (run.design = design_read(design, error)) != NULL && batch_plan_init(&run.plan, run.design, error)) {
        run.plan.first_case = run.share.shard - 1;
        run.plan.stride = run.share.n_shards;
        batch_warn(&run.plan);
        is_partial = options->check ? batch_check(&run.plan, error) : run_shard(&run, error);
        batch_plan_free(&run.plan);
    }
    design_delete(&run.design);
    return is_partial ? EVL_EXIT_PARTIAL : error->code;
}
