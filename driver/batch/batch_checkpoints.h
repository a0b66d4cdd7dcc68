/** Where the checkpoints of a shard's cases lie: FOLDER/shard-I-of-N.checkpoints, in it a folder for each case that has some. They go
 *  when the case's row is on the disk. */
#pragma once

#include "base/status.h"

typedef struct {
    char *folder;
    double interval; /**< clock [s]; INFINITY: there are none */
} batch_checkpoints;

/** Minutes as --checkpoint takes them. @return false if a text means none; 0 becomes INFINITY */
bool batch_checkpoints_read(const char *minutes, double *interval);

/** Whether a case has some. Costs next to nothing where no case has. */
bool batch_checkpoints_has(const batch_checkpoints *self, long index);
/** How far its newest checkpoint is: model time [s]; -INFINITY if there is none that can be read. */
double batch_checkpoints_reach(const batch_checkpoints *self, long index);
/** The folder of a case: a new string. */
char *batch_checkpoints_path(const batch_checkpoints *self, long index);
/** Make it, on the disk. @return false with the reason in `error`, EVL_EXIT_IO; a link is no folder */
bool batch_checkpoints_make(const batch_checkpoints *self, long index, evl_error *error);

/** Delete those of a case. What cannot be deleted stays: it does no harm. */
void batch_checkpoints_remove(const batch_checkpoints *self, long index);
/** Delete those of all cases that are not to be run.
 *  @param todo  [n] numbers of the cases that are, rising */
void batch_checkpoints_keep(const batch_checkpoints *self, long n, const long *todo);
