#include "files/seal.h"

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

enum { SEAL_LENGTH = 64 };
typedef enum { AT_FRONT, AT_END } seal_place;
static const char mark[] = "evolvent-seal 1 crc32 ", first[] = " of the first ";
enum { FIRST = sizeof mark - 1 + 8 }; /* offset of that text in the checksum line of a file's first bytes */

/** Write the complete line. It also serves to recognise a checksum: lines are compared, not parsed. */
static void write_seal(char seal[SEAL_LENGTH + 1], uint32_t check, off_t n, bool is_of_all)
{
    const int length = snprintf(seal, SEAL_LENGTH + 1, "%s%08x%s%lld bytes", mark, (unsigned)check,
                                is_of_all ? " of " : first, (long long)n);
    memset(seal + length, ' ', (size_t)(SEAL_LENGTH - length));
    seal[SEAL_LENGTH - 1] = '\n';
    seal[SEAL_LENGTH] = '\0';
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
    OWNED char *piece = xcalloc(PIECE, 1);
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
    char seal[SEAL_LENGTH + 1];
    write_seal(seal, check, is_of_all ? status.st_size : n, is_of_all);
    return write_bytes(descriptor, status.st_size, seal, SEAL_LENGTH) == SEAL_LENGTH;
}

bool seal_put(int descriptor)
{
    return put(descriptor, 0, true);
}

bool seal_put_on_first(int descriptor, long long n)
{
    return put(descriptor, (off_t)n, false);
}

/** Number of bytes covered by a checksum, as stated in its line; at most `most`. */
static off_t bytes_of(const char *seal, off_t most)
{
    char digits[16] = "";
    const size_t begin = FIRST + sizeof first - 1;
    memcpy(digits, seal + begin, sizeof digits - 1);
    const long long n = strtoll(digits, NULL, 10);
    return n < 0 || n > most ? most : (off_t)n;
}

static seal_answer check_place(int descriptor, off_t size, seal_place place)
{
    char found[SEAL_LENGTH], wanted[SEAL_LENGTH + 1];
    uint32_t check = 0;
    off_t n = size - SEAL_LENGTH;
    if (n < 0) {
        return SEAL_NONE;
    }
    if (!read_at(descriptor, found, SEAL_LENGTH, place == AT_FRONT ? 0 : n)) {
        return SEAL_UNREADABLE;
    }
    if (memcmp(found, mark, sizeof mark - 1) != 0) {
        return SEAL_NONE;
    }
    const bool is_of_all = place == AT_FRONT || memcmp(found + FIRST, first, sizeof first - 1) != 0;
    n = is_of_all ? n : bytes_of(found, n);
    if (!find_check(descriptor, place == AT_FRONT ? SEAL_LENGTH : 0, n, &check)) {
        return SEAL_UNREADABLE;
    }
    write_seal(wanted, check, n, is_of_all);
    return memcmp(found, wanted, SEAL_LENGTH) == 0 ? SEAL_HOLDS : SEAL_BROKEN;
}

seal_answer seal_check(const char *path)
{
    struct stat status;
    seal_answer answer = SEAL_UNREADABLE;
    const int descriptor = open(path, O_RDONLY | O_CLOEXEC);
    if (descriptor >= 0 && fstat(descriptor, &status) == 0) {
        answer = check_place(descriptor, status.st_size, AT_FRONT);
        answer = answer == SEAL_NONE ? check_place(descriptor, status.st_size, AT_END) : answer;
    }
    const int reason = errno;
    if (descriptor >= 0) {
        (void)close(descriptor);
    }
    errno = reason;
    return answer;
}
