/** A run that can go on after it was stopped: its history in closed parts, its state in checkpoints beside them. */
#pragma once

#include "base/archive.h"
#include "base/status.h"
#include "commands/checkpoint_options.h"
#include "files/history.h"
#include "files/parts.h"
#include "simulate/simulate.h"

typedef struct checkpoints checkpoints;

/** Open the folder of a history, and find what is to be gone on from.
 *  @param path  of the history
 *  @param command  by which it goes on, for messages
 *  @return NULL with the reason in `error`: another run is at work there, no checkpoint, or one of something else */
checkpoints *checkpoints_open(const checkpoint_options *options, const char *path, const char *command,
                              const prepared_case *prepared, evl_error *error);
/** Let go of the folder, which stays. */
void checkpoints_close(checkpoints **checkpoints);

/** What it goes on from; NULL: from the start. */
archive *checkpoints_resume(checkpoints *checkpoints);
/** Model time there; 0 at the start [s]. */
double checkpoints_time(const checkpoints *checkpoints);
/** Name of the part that comes next. */
const char *checkpoints_part(checkpoints *checkpoints);
/** More rows, or events, of the present part. */
void checkpoints_count(checkpoints *checkpoints, int n_rows, int n_events);
/** Begin anew at the last checkpoint, or the start: what came after is not to be trusted. No part is open. */
bool checkpoints_again(checkpoints *checkpoints, evl_error *error);

/* As of simulate_sink. */
bool checkpoints_is_due(checkpoints *checkpoints, double t);
void checkpoints_keep(checkpoints *checkpoints, archive *archive);
/** @param part  the present part, or NULL: is closed then. On SIMULATE_FAILS the reason is in `error` */
simulate_kept checkpoints_kept(checkpoints *checkpoints, history **part, double t, const archive *archive,
                               evl_error *error);

/** Close the last part, if there is one. */
bool checkpoints_close_part(checkpoints *checkpoints, history **part, evl_error *error);
/** All parts, one after the other. */
bool checkpoints_append(const checkpoints *checkpoints, history *to, evl_error *error);
/** The history is complete: nothing is left to go on from. */
void checkpoints_remove(checkpoints *checkpoints);

/** Model times of the checkpoints, with commas, as --checkpoint-at takes them; "" if there was none. It lasts until the next. */
const char *checkpoints_times(const checkpoints *checkpoints);
/** By which the run goes on. */
const char *checkpoints_command(const checkpoints *checkpoints);
/** Of a run that could not write: say how it goes on, if there is a checkpoint. */
void checkpoints_remind(const checkpoints *checkpoints, evl_error *error);
/** Why and where the run was stopped, and how it goes on. */
void checkpoints_explain(const checkpoints *checkpoints, const char *place, evl_error *error);
