#include "files/checksum.h"

#include "base/crc32.h"
#include "base/memory.h"
#include "base/write_bytes.h"

#include <errno.h>
#include <fcntl.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { CHECKSUM_LENGTH = 64 };
typedef enum { AT_FRONT, AT_END } checksum_side;
static const char mark[] = "evolvent-seal 1 crc32 ", first[] = " of the first ";
enum { FIRST = sizeof mark - 1 + 8 }; /* offset of that text in the checksum line of a file's first bytes */

/** Write the complete line. It also serves to recognise a checksum: lines are compared, not parsed. */
static void format_line(char line[CHECKSUM_LENGTH + 1], uint32_t check, off_t n, bool is_of_all)
{
    const int length = snprintf(line, CHECKSUM_LENGTH + 1, "%s%08x%s%lld bytes", mark, (unsigned)check,
                                is_of_all ? " of " : first, (long long)n);
    memset(line + length, ' ', (size_t)(CHECKSUM_LENGTH - length));
    line[CHECKSUM_LENGTH - 1] = '\n';
    line[CHECKSUM_LENGTH] = '\0';
}

/** pread of the complete range. */
static bool read_at(int descriptor, void *bytes, size_t n, off_t from)
{
    size_t done = 0;
    while (done < n) {
        const ssize_t part = pread(descriptor, (char *)bytes + done, n - done, from + (off_t)done);
        if (part == 0) {
            errno = EIO; /* the file has been truncated */
        }
        if (part == 0 || (part < 0 && errno != EINTR)) {
            return false;
        }
        done += part > 0 ? (size_t)part : 0;
    }
    return true;
}

static bool find_check(int descriptor, off_t from, off_t n, uint32_t *check)
{
    enum { PIECE = 256 * 1024 };
    CLEANUP_FREE char *piece = xcalloc(PIECE, 1);
    *check = 0;
    for (off_t done = 0; done < n;) {
        const size_t part = n - done < PIECE ? (size_t)(n - done) : PIECE;
        if (!read_at(descriptor, piece, part, from + done)) {
            return false;
        }
        *check = crc32_on(*check, piece, part);
        done += (off_t)part;
    }
    return true;
}

static bool put(int descriptor, off_t n, bool is_of_all)
{
    struct stat status;
    uint32_t check = 0;
    if (fstat(descriptor, &status) != 0 || !find_check(descriptor, 0, is_of_all ? status.st_size : n, &check)) {
        return false;
    }
    char line[CHECKSUM_LENGTH + 1];
    format_line(line, check, is_of_all ? status.st_size : n, is_of_all);
    return write_bytes(descriptor, status.st_size, line, CHECKSUM_LENGTH) == CHECKSUM_LENGTH;
}

bool checksum_append(int descriptor)
{
    return put(descriptor, 0, true);
}

bool checksum_append_of_first(int descriptor, long long n)
{
    return put(descriptor, (off_t)n, false);
}

/** Number of bytes covered by a checksum, as stated in its line; at most `most`. */
static off_t bytes_of(const char *line, off_t most)
{
    char digits[16] = "";
    const size_t begin = FIRST + sizeof first - 1;
    memcpy(digits, line + begin, sizeof digits - 1);
    const long long n = strtoll(digits, NULL, 10);
    return n < 0 || n > most ? most : (off_t)n;
}

static checksum_status check_side(int descriptor, off_t size, checksum_side side)
{
    char found[CHECKSUM_LENGTH], expected[CHECKSUM_LENGTH + 1];
    uint32_t check = 0;
    off_t n = size - CHECKSUM_LENGTH;
    if (n < 0) {
        return CHECKSUM_NONE;
    }
    if (!read_at(descriptor, found, CHECKSUM_LENGTH, side == AT_FRONT ? 0 : n)) {
        return CHECKSUM_UNREADABLE;
    }
    if (memcmp(found, mark, sizeof mark - 1) != 0) {
        return CHECKSUM_NONE;
    }
    const bool is_of_all = side == AT_FRONT || memcmp(found + FIRST, first, sizeof first - 1) != 0;
    n = is_of_all ? n : bytes_of(found, n);
    if (!find_check(descriptor, side == AT_FRONT ? CHECKSUM_LENGTH : 0, n, &check)) {
        return CHECKSUM_UNREADABLE;
    }
    format_line(expected, check, n, is_of_all);
    return memcmp(found, expected, CHECKSUM_LENGTH) == 0 ? CHECKSUM_CORRECT : CHECKSUM_WRONG;
}

checksum_status checksum_verify(const char *path)
{
    struct stat status;
    checksum_status result = CHECKSUM_UNREADABLE;
    const int descriptor = open(path, O_RDONLY | O_CLOEXEC);
    if (descriptor >= 0 && fstat(descriptor, &status) == 0) {
        result = check_side(descriptor, status.st_size, AT_FRONT);
        result = result == CHECKSUM_NONE ? check_side(descriptor, status.st_size, AT_END) : result;
    }
    const int reason = errno;
    if (descriptor >= 0) {
        (void)close(descriptor);
    }
    errno = reason;
    return result;
}
