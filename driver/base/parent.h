/** Optional end of a process together with its parent. Leaf module. */
#pragma once

#include "base/status.h"

/** If the environment variable EVOLVENT_PARENT names a process, receive SIGTERM when the parent process ends, on
 *  systems that support it (Linux). An orphaned job would hold its lock and continue to write.
 *  @return false with the reason in `error`, EVL_EXIT_INTERRUPTED: the named process no longer exists */
bool parent_follow(evl_error *error);
