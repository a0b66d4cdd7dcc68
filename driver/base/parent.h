/** A process that ends with the one that started it, if that wants so. A leaf. */
#pragma once

#include "base/status.h"

/** If the variable EVOLVENT_PARENT of the environment names a process, be sent SIGTERM when the process ends that started this
 *  one; where the system can do that (Linux). A job that was left alone would hold its lock, and go on writing.
 *  @return false with the reason in `error`, EVL_EXIT_INTERRUPTED: the process that is named is gone already */
bool parent_follow(evl_error *error);
