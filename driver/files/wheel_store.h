/** Compliant wheels, each computed once: in the memory of a process, and for several processes in a folder, one file
 *  per wheel. */
#pragma once

#include "base/status.h"

#include <evolvent/description.h>

typedef struct wheel_store wheel_store;

/** An empty store, in memory only. */
wheel_store *wheel_store_create(void);
void wheel_store_delete(wheel_store **store);

/** Share a folder with other processes, on any machine: from now on the files FOLDER/compliance-HASH.h5 apply, also to
 *  wheels already in memory, and new results are written there. @return false with the reason in `error` */
bool wheel_store_share(wheel_store *store, const char *folder, evl_error *error);

/** Interface for the model. */
const evl_wheel_store *wheel_store_door(const wheel_store *store);
/** Number of wheels computed by this process. */
long wheel_store_computed(const wheel_store *store);
/** Why a file could not be written or was refused; EVL_EXIT_OK if none was. Not an error of a case. */
const evl_error *wheel_store_error(const wheel_store *store);
