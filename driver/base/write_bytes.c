#include "base/write_bytes.h"

#include <errno.h>
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
