#include "base/parent.h"

#include <errno.h>
#include <signal.h>
#include <stdlib.h>
#include <sys/types.h>
#ifdef __linux__
#include <sys/prctl.h>
#endif

bool parent_follow(evl_error *error)
{
    const char *named = getenv("EVOLVENT_PARENT");
    const long pid = named == NULL ? 0 : strtol(named, NULL, 10);
    if (pid <= 1) {
        return true;
    }
#ifdef __linux__
    (void)prctl(PR_SET_PDEATHSIG, SIGTERM);
#endif
    if (kill((pid_t)pid, 0) != 0 && errno == ESRCH) {
        return evl_error_set(error, EVL_EXIT_INTERRUPTED, "", "its parent process, %ld, has ended", pid);
    }
    return true;
}
