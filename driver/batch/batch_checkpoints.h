/** Location of the checkpoints of a shard's cases: FOLDER/shard-I-of-N.checkpoints, with a folder for each case that
 *  has checkpoints. They are deleted when the case's row is on the disk. */
#pragma once

#include "base/status.h"

typedef struct {
    char *folder;
    double interval; /**< wall clock [s]; INFINITY: no checkpoints */
} batch_checkpoints;

/** Read minutes in the format of --checkpoint. @return false for an invalid text; 0 becomes INFINITY */
bool batch_checkpoints_read(const char *minutes, double *interval);

/** Whether a case has checkpoints. Negligible cost if no case has any. */
bool batch_checkpoints_has(const batch_checkpoints *self, long index);
/** Model time of its newest checkpoint [s]; -INFINITY if there is none that can be read. */
double batch_checkpoints_reach(const batch_checkpoints *self, long index);
/** The folder of a case: a new string. */
char *batch_checkpoints_path(const batch_checkpoints *self, long index);
/** Create the folder on the disk. @return false with the reason in `error`, EVL_EXIT_IO; a link is not accepted as a
 *  folder */
bool batch_checkpoints_make(const batch_checkpoints *self, long index, evl_error *error);

/** Delete the checkpoints of a case. Files that cannot be deleted remain and do no harm. */
void batch_checkpoints_remove(const batch_checkpoints *self, long index);
/** Delete the checkpoints of all cases that are not to be run.
 *  @param todo  [n] numbers of the cases to run, ascending */
void batch_checkpoints_retain(const batch_checkpoints *self, long n, const long *todo);
