/** A state of a run on file, from which it can go on. The interface knows nothing of HDF5; checkpoint_hdf5.c does.
 *
 *  In a folder there are up to two, checkpoint.h5 and the one before it: the older goes only when the newer is complete and on disk.
 *  In front of each stands a check of all its bytes, which are looked at before HDF5 is. */
#pragma once

#include "base/archive.h"
#include "base/status.h"

#include <stdbool.h>

/** What the state is of. */
typedef enum {
    CHECKPOINT_PROGRAM,
    CHECKPOINT_INTEGRATOR, /**< library and version */
    CHECKPOINT_KERNEL,     /**< compiler and processor */
    CHECKPOINT_CASE,       /**< its whole text, all defaults filled in, and whatever else decides */
    N_CHECKPOINT_TEXTS
} checkpoint_text;

typedef struct checkpoint {
    char *texts[N_CHECKPOINT_TEXTS];
    double t;      /**< model time [s] */
    archive state; /**< to be read, in one that was read */
} checkpoint;

/** Say what a checkpoint is of: this program and kernel, with this integrator and case. */
void checkpoint_identify(checkpoint *own, const char *integrator, const char *text);
/** Hold one that was read against what it should be of.
 *  @return the text in which they differ, with the words for it in `error`, EVL_EXIT_CASE; N_CHECKPOINT_TEXTS if in none */
int checkpoint_compare(const checkpoint *own, const checkpoint *found, const char *place, evl_error *error);

/** Put a checkpoint into a folder; the one that was there becomes the one before it.
 *  @return false with the reason in `error`, EVL_EXIT_IO: then those that were there still are */
bool checkpoint_write(const char *folder, const checkpoint *checkpoint, evl_error *error);
/** Read the newest checkpoint of a folder that is whole. If that is the older one, it takes the place of the newer.
 *  @param doubt  what was wrong with a newer one, of length EVL_ERROR_MESSAGE_LENGTH; "" if nothing was
 *  @return false with the reason in `error`, EVL_EXIT_CASE, if there is none. In any case it is to be freed */
bool checkpoint_read(const char *folder, checkpoint *checkpoint, char *doubt, evl_error *error);
/** Whether there is one, whole or not. */
bool checkpoint_exists(const char *folder);
/** Delete those of a folder, the older one first. @return whether none is left */
bool checkpoint_remove(const char *folder);
void checkpoint_free(checkpoint *checkpoint);
