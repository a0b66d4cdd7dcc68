#include "base/lock.h"

#include "base/log.h"
#include "base/write_bytes.h"

#include <errno.h>
#include <fcntl.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

/** The holder's description of itself, on one line. */
static void read_owner(int descriptor, char *text, size_t size)
{
    const ssize_t n = pread(descriptor, text, size - 1, 0);
    text[n > 0 ? n : 0] = '\0';
    text[strcspn(text, "\n")] = '\0';
}

/** Information for a user whose lock is refused; the lock works without it. */
static void write_owner(int descriptor)
{
    char host[128] = "unknown", when[32] = "", text[256];
    const time_t now = time(NULL);
    struct tm utc;
    (void)gethostname(host, sizeof host - 1);
    if (gmtime_r(&now, &utc) != NULL) {
        (void)strftime(when, sizeof when, "%Y-%m-%dT%H:%M:%SZ", &utc);
    }
    const int length = snprintf(text, sizeof text, "pid %ld on %s since %s\n", (long)getpid(), host, when);
    (void)(ftruncate(descriptor, 0) == 0 && write_bytes(descriptor, 0, text, (size_t)length) > 0);
}

bool file_lock_take(file_lock *lock, const char *path, evl_error *error)
{
    /* POSIX lock: it works across the machines that share a folder, and worker processes do not inherit it. */
    struct flock region = {.l_type = F_WRLCK, .l_whence = SEEK_SET};
    lock->descriptor = open(path, O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0666);
    if (lock->descriptor < 0) {
        return evl_error_set_unwritten(error, path);
    }
    if (fcntl(lock->descriptor, F_SETLK, &region) == 0) {
        write_owner(lock->descriptor);
        return true;
    }
    if (errno == EACCES || errno == EAGAIN) {
        char owner[256];
        read_owner(lock->descriptor, owner, sizeof owner);
        file_lock_release(lock);
        return evl_error_set(error, EVL_EXIT_CASE, path,
                             "another run uses this folder (%s); wait until it ends, or stop it first",
                             owner[0] != '\0' ? owner : "its process is unknown");
    }
    log_warning("%s: this folder does not support locks (%s); make sure that no second run uses it", path,
                strerror(errno));
    return true;
}

void file_lock_release(file_lock *lock)
{
    if (lock->descriptor >= 0) {
        (void)close(lock->descriptor);
        lock->descriptor = -1;
    }
}
