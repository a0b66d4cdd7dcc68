/** Wheels that give way, each computed once: in the memory of a process, and for many processes in a folder, a file a wheel. */
#pragma once

#include "base/status.h"

#include <evolvent/description.h>

typedef struct wheel_store wheel_store;

/** An empty one, in memory alone. */
wheel_store *wheel_store_create(void);
void wheel_store_delete(wheel_store **store);

/** Share a folder with other processes, on whatever machine: from now on the files FOLDER/compliance-HASH.h5 count, also for what
 *  is known already, and what is computed becomes one. @return false with the reason in `error` */
bool wheel_store_share(wheel_store *store, const char *folder, evl_error *error);

/** What a model asks. */
const evl_wheel_store *wheel_store_door(const wheel_store *store);
/** How many wheels this process has computed. */
long wheel_store_computed(const wheel_store *store);
/** Why a file could not be written or was refused; EVL_EXIT_OK as long as nothing was. No fault of a case. */
const evl_error *wheel_store_error(const wheel_store *store);
