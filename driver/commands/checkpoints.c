#include "commands/checkpoints.h"

#include "base/interrupt.h"
#include "base/log.h"
#include "base/memory.h"
#include "base/number.h"
#include "base/progress.h"
#include "case/former_keys.h"
#include "files/checkpoint.h"
#include "integrate/integrate.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct checkpoints {
    parts parts;
    char *command, *part; /**< part: name of the next one */
    checkpoint from;      /**< checkpoint to resume from, and the identification of all checkpoints */
    bool resumes;
    double interval, max_time; /**< wall clock [s], INFINITY: never */
    int n_at, next_at;
    double *at;                    /**< [n_at] model times, ascending; those from next_at on are still to come */
    double started, last, longest; /**< wall clock [s]: of the start, of the last checkpoint; longest duration of one */
    bool out_of_time;
    double t, t_due;            /**< model time of the last one, and of the present one */
    long long n_rows, n_events; /**< so far */
    size_t n_times;             /**< length of `times` in bytes */
    char *times;
};

/* ---- resume ---- */

/** Set the identification of this run's checkpoints. */
static void identify(checkpoint *own, const case_plan *plan)
{
    const bool by_stepper = plan->integration.by_stepper;
    CLEANUP_FREE char *text = case_text_of_motion(plan->file);
    checkpoint_identify(own, by_stepper ? "radau" : integrate_version(), text);
}

/** The newest checkpoint that is complete and belongs to this case and program. @param[out] found  to be freed in any
 *  case */
static bool read_own(const checkpoints *self, checkpoint *found, char *doubt, evl_error *error)
{
    static const char *const remedies[N_CHECKPOINT_TEXTS] = {"continue with that program", "continue with that library",
                                                             "continue on a machine with that kernel",
                                                             "continue with that case"};
    evl_error why = {.code = EVL_EXIT_OK};
    if (!checkpoint_read(self->parts.folder, found, doubt, &why)) {
        return evl_error_set(error, why.code, why.location, "%s; start again without --continue", why.message);
    }
    case_text_use_present_keys(&found->texts[CHECKPOINT_CASE]);
    const int text = checkpoint_compare(&self->from, found, self->parts.folder, &why);
    return text == N_CHECKPOINT_TEXTS ||
           evl_error_set(error, why.code, why.location, "%s; %s, or start again without --continue", why.message,
                         remedies[text]);
}

/** Header of a checkpoint: number of parts before it, their size, and the interval of the checkpoints. */
typedef struct {
    int n_parts;
    long long n_rows, n_events;
    double interval;
} head;

static void serialize_head(head *head, archive *state)
{
    SERIALIZE(state, head->n_parts);
    SERIALIZE(state, head->n_rows);
    SERIALIZE(state, head->n_events);
    SERIALIZE(state, head->interval);
}

static bool check_parts(const checkpoints *self, const head *head, evl_error *error)
{
    part_size total = {0, 0}, size;
    for (int i = 1; i <= head->n_parts; i++) {
        CLEANUP_FREE char *path = parts_path(&self->parts, i);
        if (!part_size_of(path, &size)) {
            return evl_error_set(error, EVL_EXIT_CASE, path,
                                 "the part is missing, or damaged; start again without --continue");
        }
        total.rows += size.rows;
        total.events += size.events;
    }
    return (total.rows == head->n_rows && total.events == head->n_events) ||
           evl_error_set(error, EVL_EXIT_CASE, self->parts.folder,
                         "its parts hold %lld outputs and %lld events, but its checkpoint states %lld and %lld; start "
                         "again without --continue",
                         total.rows, total.events, head->n_rows, head->n_events);
}

static bool find_checkpoint(checkpoints *self, const char *path, evl_error *error)
{
    checkpoint found;
    char doubt[EVL_ERROR_MESSAGE_LENGTH];
    head head = {0};
    bool good = read_own(self, &found, doubt, error);
    serialize_head(&head, &found.state);
    good = good && check_parts(self, &head, error) && parts_retain(&self->parts, head.n_parts, error);
    if (good && doubt[0] != '\0') {
        log_warning("%s: the run continues from the previous checkpoint", doubt);
    }
    if (good) {
        archive_free(&self->from.state);
        self->from.state = found.state;
        self->from.t = self->t = found.t;
        self->resumes = true;
        self->interval = head.interval;
        found.state = (archive){.n = 0};
        log_note("%s continues from its checkpoint at t = %.9g s", path, self->t);
    }
    checkpoint_free(&found);
    return good;
}

/** Use the folder of an earlier run only if nothing is lost by that. */
static bool begin_anew(checkpoints *self, evl_error *error)
{
    if (checkpoint_exists(self->parts.folder)) {
        return evl_error_set(error, EVL_EXIT_CASE, self->parts.folder,
                             "a stopped run can be resumed from here; add --continue, or delete the folder");
    }
    (void)checkpoint_remove(self->parts.folder); /* an incomplete one */
    return parts_retain(&self->parts, 0, error);
}

/** @return whether one of the model times is reached */
static bool pass_times(checkpoints *self, double t)
{
    const int before = self->next_at;
    while (self->next_at < self->n_at && t >= self->at[self->next_at]) {
        self->next_at++;
    }
    return self->next_at > before;
}

checkpoints *checkpoints_open(const checkpoint_options *options, const char *path, const char *command,
                              const case_plan *plan, evl_error *error)
{
    CLEANUP_FREE char *folder = parts_folder(path);
    if (options->continues && !checkpoint_exists(folder)) {
        (void)evl_error_set(error, EVL_EXIT_CASE, "", "there is no checkpoint in '%s'; start without --continue",
                            folder);
        return NULL;
    }
    checkpoints *self = xcalloc(1, sizeof *self);
    *self = (checkpoints){.interval = INFINITY, .max_time = INFINITY, .started = clock_seconds()};
    self->last = self->started;
    self->command = xstrdup(command);
    self->times = xstrdup("");
    (void)(options->max_minutes != NULL && checkpoint_minutes(options->max_minutes, &self->max_time));
    identify(&self->from, plan);
    if (!parts_open(&self->parts, path, error) ||
        !(options->continues ? find_checkpoint(self, path, error) : begin_anew(self, error))) {
        CLEANUP_FREE char *text = error->location[0] != '\0' ? evl_error_text(error) : xstrdup(error->message);
        evl_error_set(error, error->code, "", "%s", text); /* none of these errors concerns the case */
        checkpoints_close(&self);
        return NULL;
    }
    (void)(options->minutes != NULL && checkpoint_minutes(options->minutes, &self->interval));
    if (options->at != NULL) {
        self->at = xcalloc(strlen(options->at) + 1, sizeof *self->at);
        self->n_at = checkpoint_times(options->at, self->at);
        (void)pass_times(self, self->t);
    }
    return self;
}

void checkpoints_close(checkpoints **pointer)
{
    checkpoints *self = *pointer;
    *pointer = NULL;
    if (self != NULL) {
        parts_close(&self->parts);
        checkpoint_free(&self->from);
        free(self->command);
        free(self->part);
        free(self->at);
        free(self->times);
        free(self);
    }
}

archive *checkpoints_resume(checkpoints *self)
{
    return self->resumes ? &self->from.state : NULL;
}

double checkpoints_time(const checkpoints *self)
{
    return self->t;
}

bool checkpoints_again(checkpoints *self, evl_error *error)
{
    self->next_at = 0;
    if (checkpoint_exists(self->parts.folder)) {
        const double interval = self->interval;
        const bool good = find_checkpoint(self, self->parts.folder, error);
        self->interval = interval;
        (void)pass_times(self, self->t);
        return good;
    }
    self->n_rows = self->n_events = 0;
    self->times[0] = '\0'; /* the missed event may have appeared when the first one was written */
    self->n_times = 0;
    return parts_retain(&self->parts, 0, error);
}

/* ---- parts ---- */

const char *checkpoints_part(checkpoints *self)
{
    free(self->part);
    self->part = parts_path(&self->parts, self->parts.n + 1);
    return self->part;
}

void checkpoints_count(checkpoints *self, int n_rows, int n_events)
{
    self->n_rows += n_rows;
    self->n_events += n_events;
}

bool checkpoints_close_part(checkpoints *self, history **part, evl_error *error)
{
    static const history_attribute attributes[] = {
        {"status", .text = "part"},
        {"status_message", .text = "a part of an incomplete run; the next part continues it"}};
    if (*part == NULL) {
        return true;
    }
    self->parts.n++;
    return history_close(part, true, 2, attributes, error);
}

bool checkpoints_append(const checkpoints *self, history *to, evl_error *error)
{
    bool good = true;
    for (int i = 1; i <= self->parts.n && good; i++) {
        CLEANUP_FREE char *path = parts_path(&self->parts, i);
        good = part_append(path, to, error);
    }
    return good;
}

void checkpoints_remove(checkpoints *self)
{
    parts_remove(&self->parts);
}

/* ---- checkpoints ---- */

bool checkpoints_is_due(checkpoints *self, double t)
{
    /* The checkpoint must be complete by then: the margin is twice the longest duration so far, but at least a second,
     * or for a short limit a part of it. */
    static const double times = 2, least = 1, part = 0.05;
    const double margin = fmax(times * self->longest, fmin(least, part * self->max_time)), now = clock_seconds();
    self->t_due = t;
    self->out_of_time = now - self->started + margin >= self->max_time;
    if (pass_times(self, t)) {
        return true;
    }
    return interrupt_signal != 0 || self->out_of_time || now - self->last >= self->interval;
}

/** Append the time of the present checkpoint to the list. */
static void note_time(checkpoints *self)
{
    char number[NUMBER_TEXT_LENGTH];
    number_write(number, self->t_due);
    char *longer = xasprintf("%s%s%s", self->times, self->n_times > 0 ? "," : "", number);
    free(self->times);
    self->times = longer;
    self->n_times = strlen(longer);
}

void checkpoints_serialize(checkpoints *self, archive *archive)
{
    if (!archive->is_reading) {
        note_time(self);
    }
    SERIALIZE(archive, self->n_rows);
    SERIALIZE(archive, self->n_events);
    SERIALIZE(archive, self->n_times);
    if (archive->is_reading) {
        archive->has_failed = archive->has_failed || self->n_times > archive->n;
        free(self->times);
        self->times = xcalloc(archive->has_failed ? 1 : self->n_times + 1, 1);
    }
    SERIALIZE_ARRAY(archive, self->times, archive->has_failed ? 0 : self->n_times);
}

simulate_checkpoint_outcome checkpoints_write(checkpoints *self, history **part, double t, const archive *state,
                                              evl_error *error)
{
    const double begun = clock_seconds();
    checkpoint next = self->from;
    next.t = t;
    next.state = (archive){.n = 0};
    bool good = checkpoints_close_part(self, part, error);
    head head = {self->parts.n, self->n_rows, self->n_events, self->interval};
    serialize_head(&head, &next.state);
    memcpy(archive_take(&next.state, state->n), state->bytes, state->n);
    good = good && checkpoint_write(self->parts.folder, &next, error);
    archive_free(&next.state);
    if (!good) {
        return SIMULATE_FAILS;
    }
    self->t = t;
    self->last = clock_seconds();
    self->longest = fmax(self->longest, self->last - begun);
    return interrupt_signal != 0 || self->out_of_time ? SIMULATE_STOPS : SIMULATE_GOES_ON;
}

const char *checkpoints_times(const checkpoints *self)
{
    return self->times;
}

const char *checkpoints_command(const checkpoints *self)
{
    return self->command;
}

void checkpoints_explain(const checkpoints *self, const char *location, evl_error *error)
{
    if (interrupt_signal != 0) {
        evl_error_set(error, EVL_EXIT_INTERRUPTED, location, "interrupted by %s; continue from here with: %s",
                      interrupt_name((int)interrupt_signal), self->command);
    } else {
        evl_error_set(error, EVL_EXIT_INTERRUPTED, location, "stopped by --max-time; continue from here with: %s",
                      self->command);
    }
}

void checkpoints_remind(const checkpoints *self, evl_error *error)
{
    if (checkpoint_exists(self->parts.folder)) {
        CLEANUP_FREE char *message = xstrdup(error->message), *location = xstrdup(error->location);
        evl_error_set(error, error->code, location, "%s; then continue from t = %.9g s with: %s", message, self->t,
                      self->command);
    }
}
