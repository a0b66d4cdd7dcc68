#include "base/write_bytes.h"

#include "base/memory.h"

#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <unistd.h>

size_t write_bytes(int descriptor, off_t offset, const void *bytes, size_t n)
{
    const char *from = bytes;
    size_t done = 0;
    while (done < n) {
        const ssize_t more = offset < 0 ? write(descriptor, from + done, n - done)
                                        : pwrite(descriptor, from + done, n - done, offset + (off_t)done);
        if (more > 0) {
            done += (size_t)more;
        } else if (more == 0 || errno != EINTR) {
            errno = more == 0 ? ENOSPC : errno;
            break;
        }
    }
    return done;
}

bool sync_bytes(int descriptor)
{
    return fsync(descriptor) == 0 || errno == EINVAL;
}

bool sync_name(const char *path)
{
    CLEANUP_FREE char *folder = xstrdup(path);
    for (size_t n = strlen(folder); n > 1 && folder[n - 1] == '/'; n--) { /* trailing slash of a folder's name */
        folder[n - 1] = '\0';
    }
    char *slash = strrchr(folder, '/');
    if (slash != NULL) {
        slash[slash == folder ? 1 : 0] = '\0';
    }
    const int descriptor = open(slash != NULL ? folder : ".", O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    const bool good = descriptor < 0 || sync_bytes(descriptor) || (errno != EIO && errno != ENOSPC && errno != EDQUOT);
    const int reason = errno;
    if (descriptor >= 0) {
        (void)close(descriptor);
    }
    errno = reason;
    return good;
}
