/** Run that can be resumed: its history in closed parts, its state in checkpoints next to them. */
#pragma once

#include "base/archive.h"
#include "base/status.h"
#include "commands/checkpoint_options.h"
#include "files/history.h"
#include "files/parts.h"
#include "simulate/simulate.h"

typedef struct checkpoints checkpoints;

/** Open the folder of a history, and find the state to resume from.
 *  @param path  of the history
 *  @param command  that resumes it, for messages
 *  @return NULL with the reason in `error`: another run uses it, no checkpoint, or one of something else */
checkpoints *checkpoints_open(const checkpoint_options *options, const char *path, const char *command,
                              const case_plan *plan, evl_error *error);
/** Release the folder, which remains. */
void checkpoints_close(checkpoints **checkpoints);

/** State to resume from; NULL: from the start. */
archive *checkpoints_resume(checkpoints *checkpoints);
/** Model time of that state; 0 at the start [s]. */
double checkpoints_time(const checkpoints *checkpoints);
/** Name of the next part. */
const char *checkpoints_part(checkpoints *checkpoints);
/** Count further rows, or events, of the present part. */
void checkpoints_count(checkpoints *checkpoints, int n_rows, int n_events);
/** Return to the last checkpoint, or the start: later results are invalid. No part is open. */
bool checkpoints_again(checkpoints *checkpoints, evl_error *error);

/* As in simulate_sink. */
bool checkpoints_is_due(checkpoints *checkpoints, double t);
void checkpoints_serialize(checkpoints *checkpoints, archive *archive);
/** @param part  the present part, or NULL: will be closed. On SIMULATE_FAILS the reason is in `error` */
simulate_checkpoint_outcome checkpoints_write(checkpoints *checkpoints, history **part, double t,
                                              const archive *archive, evl_error *error);

/** Close the last part, if there is one. */
bool checkpoints_close_part(checkpoints *checkpoints, history **part, evl_error *error);
/** Append all parts, one after the other. */
bool checkpoints_append(const checkpoints *checkpoints, history *to, evl_error *error);
/** Delete the checkpoints of a complete history. */
void checkpoints_remove(checkpoints *checkpoints);

/** Model times of the checkpoints, separated by commas, as in --checkpoint-at; "" if there was none. Valid until the
 *  next one. */
const char *checkpoints_times(const checkpoints *checkpoints);
/** Command that resumes the run. */
const char *checkpoints_command(const checkpoints *checkpoints);
/** After a failed write: report how to resume the run, if there is a checkpoint. */
void checkpoints_remind(const checkpoints *checkpoints, evl_error *error);
/** Report why and where the run was stopped, and how to resume it. */
void checkpoints_explain(const checkpoints *checkpoints, const char *location, evl_error *error);
