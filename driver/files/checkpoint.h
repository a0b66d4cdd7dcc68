/** Checkpoint of a run on file, from which it can be resumed. The interface is independent of HDF5; checkpoint_hdf5.c
 *  uses it.
 *
 *  A folder contains up to two, checkpoint.h5 and the previous one: the older is deleted only when the newer is
 *  complete and on disk. Each starts with a checksum of all its bytes, which is verified before HDF5 reads it. */
#pragma once

#include "base/archive.h"
#include "base/status.h"

#include <stdbool.h>

/** Identification of a state. */
typedef enum {
    CHECKPOINT_PROGRAM,
    CHECKPOINT_INTEGRATOR, /**< library and version */
    CHECKPOINT_KERNEL,     /**< compiler and processor */
    CHECKPOINT_CASE, /**< its complete text, all defaults filled in, and everything else that affects the result */
    N_CHECKPOINT_TEXTS
} checkpoint_text;

typedef struct checkpoint {
    char *texts[N_CHECKPOINT_TEXTS];
    double t;      /**< model time [s] */
    archive state; /**< of a checkpoint that was read: ready to be read */
} checkpoint;

/** Set the identification of a checkpoint: this program and kernel, with this integrator and case. */
void checkpoint_identify(checkpoint *own, const char *integrator, const char *text);
/** Compare the identification of a checkpoint that was read with the expected one.
 *  @return the text in which they differ, with a message in `error`, EVL_EXIT_CASE; N_CHECKPOINT_TEXTS if in none */
int checkpoint_compare(const checkpoint *own, const checkpoint *found, const char *location, evl_error *error);

/** Write a checkpoint to a folder; an existing one becomes the previous one.
 *  @return false with the reason in `error`, EVL_EXIT_IO: then the existing ones are unchanged */
bool checkpoint_write(const char *folder, const checkpoint *checkpoint, evl_error *error);
/** Read the newest complete checkpoint of a folder. If that is the older one, it replaces the newer one.
 *  @param doubt  the fault of a newer one, of length EVL_ERROR_MESSAGE_LENGTH; "" if there is none
 *  @return false with the reason in `error`, EVL_EXIT_CASE, if there is none. Free it in any case */
bool checkpoint_read(const char *folder, checkpoint *checkpoint, char *doubt, evl_error *error);
/** Whether there is one, complete or not. */
bool checkpoint_exists(const char *folder);
/** Delete the checkpoints of a folder, the older one first. @return whether none is left */
bool checkpoint_remove(const char *folder);
void checkpoint_free(checkpoint *checkpoint);
