#include "batch/batch_checkpointer.h"

#include "base/log.h"
#include "base/memory.h"
#include "base/progress.h"
#include "case/former_keys.h"
#include "files/checkpoint.h"

#include <math.h>
#include <string.h>

enum { STRIDE = 16 };          /* steps between readings of the clock, each of which takes a hundredth of a step */
static const double least = 1; /* [s] of work that justifies a checkpoint when the batch ends */

/** Serialise the data preceding the simulation's own state. */
static void serialize_head(batch_checkpointer *self, archive *archive)
{
    SERIALIZE(archive, self->waits);
    SERIALIZE(archive, self->cpu_seconds);
}

/** Set the identification of this case's checkpoints: includes the design, which determines the requested results. */
static void identify(const batch_checkpointer *self, checkpoint *own)
{
    CLEANUP_FREE char *text = xasprintf("case %ld of the design %s\n%s", self->index, self->plan->design->hash,
                                        case_text(self->of_case->file));
    checkpoint_identify(own, "radau", text);
}

/** @return false with the reason in `why` */
static bool find(batch_checkpointer *self, char *doubt, evl_error *why)
{
    CLEANUP_FREE char *path = batch_checkpoints_path(&self->plan->checkpoints, self->index);
    checkpoint own = {.t = 0}, found = {.t = 0};
    identify(self, &own);
    bool good = checkpoint_read(path, &found, doubt, why);
    if (good) {
        case_text_use_present_keys(&found.texts[CHECKPOINT_CASE]);
        good = checkpoint_compare(&own, &found, path, why) == N_CHECKPOINT_TEXTS;
    }
    if (good) {
        self->from = found.state;
        found.state = (archive){.n = 0};
        serialize_head(self, &self->from);
        log_note("case %ld continues from its checkpoint at t = %.9g s", self->index, found.t);
    }
    checkpoint_free(&found);
    checkpoint_free(&own);
    return good;
}

void batch_checkpointer_begin(batch_checkpointer *self, const batch_plan *plan, const batch_queue *queue, long index,
                              const case_plan *of_case, evl_error *error)
{
    const batch_checkpoints *checkpoints = &plan->checkpoints;
    char doubt[EVL_ERROR_MESSAGE_LENGTH] = "";
    evl_error why = {.code = EVL_EXIT_OK};
    *self = (batch_checkpointer){.plan = plan,
                                 .queue = queue,
                                 .of_case = of_case,
                                 .index = index,
                                 .can_go_on = isfinite(checkpoints->interval) && of_case->integration.by_stepper,
                                 .waits = true,
                                 .last = clock_seconds(),
                                 .countdown = STRIDE,
                                 .error = error};
    self->has_some = self->can_go_on && batch_checkpoints_has(checkpoints, index);
    if (self->has_some && !find(self, doubt, &why)) {
        CLEANUP_FREE char *text = evl_error_text(&why);
        log_warning("%s: case %ld restarts from time 0", text, index);
    } else if (doubt[0] != '\0') {
        log_warning("%s: case %ld continues from the previous checkpoint", doubt, index);
    }
}

void batch_checkpointer_end(batch_checkpointer *self)
{
    archive_free(&self->from);
}

archive *batch_checkpointer_resume(batch_checkpointer *self)
{
    return self->from.bytes != NULL ? &self->from : NULL;
}

void batch_checkpointer_begin_anew(batch_checkpointer *self, bool waits, double cpu_seconds)
{
    archive_free(&self->from);
    self->waits = waits;
    self->cpu_seconds = cpu_seconds;
}

bool batch_checkpointer_is_due(batch_checkpointer *self)
{
    if (batch_queue_is_stopped(self->queue)) {
        return true;
    }
    if (!self->can_go_on || --self->countdown > 0) {
        return false;
    }
    self->countdown = STRIDE;
    return clock_seconds() - self->last >= self->plan->checkpoints.interval;
}

static bool write(batch_checkpointer *self, double t, const archive *state)
{
    CLEANUP_FREE char *path = batch_checkpoints_path(&self->plan->checkpoints, self->index);
    checkpoint next = {.t = t};
    identify(self, &next);
    serialize_head(self, &next.state);
    memcpy(archive_take(&next.state, state->n), state->bytes, state->n);
    const bool good = batch_checkpoints_make(&self->plan->checkpoints, self->index, self->error) &&
                      checkpoint_write(path, &next, self->error);
    checkpoint_free(&next);
    self->has_some = true;
    return good;
}

simulate_checkpoint_outcome batch_checkpointer_write(batch_checkpointer *self, double t, const archive *state)
{
    const double since = clock_seconds() - self->last;
    if (self->can_go_on && since >= fmin(least, self->plan->checkpoints.interval)) {
        if (!write(self, t, state)) {
            return SIMULATE_FAILS;
        }
        self->last = clock_seconds();
    }
    return batch_queue_is_stopped(self->queue) ? SIMULATE_STOPS : SIMULATE_GOES_ON;
}
