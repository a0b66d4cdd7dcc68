#define _GNU_SOURCE // NOLINT(bugprone-reserved-identifier)
#include "layer.h"

#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

bool layer_is_armed;

const char *layer_setting(const char *name)
{
    const char *value = getenv(name);
    return value != NULL && value[0] != '\0' ? value : NULL;
}

void layer_next(const char *name, void *function)
{
    void *const found = dlsym(RTLD_NEXT, name);
    memcpy(function, &found, sizeof found);
}

/* ---- whose file it is ---- */

static bool is_inside(const char *path)
{
    const char *folder = layer_setting("LAYER_FOLDER");
    const size_t length = folder == NULL ? 0 : strlen(folder);
    return length > 0 && strncmp(path, folder, length) == 0 && (path[length] == '/' || path[length] == '\0');
}

/** @return false if there is none */
static bool path_of(int descriptor, char path[PATH_MAX])
{
    char link[64];
    (void)snprintf(link, sizeof link, "/proc/self/fd/%d", descriptor);
    const ssize_t n = readlink(link, path, PATH_MAX - 1);
    path[n > 0 ? n : 0] = '\0';
    return n > 0;
}

bool layer_owns(int descriptor)
{
    char path[PATH_MAX];
    return path_of(descriptor, path) && is_inside(path);
}

bool layer_owns_path(int folder, const char *path)
{
    char start[PATH_MAX], whole[2 * PATH_MAX];
    if (path[0] == '/') {
        return is_inside(path);
    }
    if (folder == AT_FDCWD ? getcwd(start, sizeof start) == NULL : !path_of(folder, start)) {
        return false;
    }
    (void)snprintf(whole, sizeof whole, "%s/%s", start, path);
    return is_inside(whole);
}

bool layer_is_socket(int descriptor)
{
    struct stat status;
    return fstat(descriptor, &status) == 0 && S_ISSOCK(status.st_mode);
}

/* ---- streams ---- */

static ssize_t stream_read(void *cookie, char *bytes, size_t n)
{
    return read((int)(intptr_t)cookie, bytes, n);
}

/** As streams do, until all is written or it fails. */
static ssize_t stream_write(void *cookie, const char *bytes, size_t n)
{
    size_t done = 0;
    while (done < n) {
        const ssize_t more = write((int)(intptr_t)cookie, bytes + done, n - done);
        if (more <= 0) {
            break;
        }
        done += (size_t)more;
    }
    return (ssize_t)done;
}

static int stream_seek(void *cookie, off64_t *offset, int whence)
{
    *offset = lseek((int)(intptr_t)cookie, *offset, whence);
    return *offset < 0 ? -1 : 0;
}

static int stream_close(void *cookie)
{
    return close((int)(intptr_t)cookie);
}

FILE *layer_stream(int descriptor, const char *mode)
{
    const cookie_io_functions_t calls = {stream_read, stream_write, stream_seek, stream_close};
    return fopencookie((void *)(intptr_t)descriptor, mode, calls); // NOLINT(performance-no-int-to-ptr)
}

void layer_take_streams(void)
{
    if (strncmp(program_invocation_short_name, "python", strlen("python")) != 0) {
        stdout = layer_stream(STDOUT_FILENO, "w");
        stderr = layer_stream(STDERR_FILENO, "w");
        (void)setvbuf(stderr, NULL, _IONBF, 0);
    }
}

/* ---- main ---- */

static int (*real_main)(int, char **, char **);

static int begin(int n, char **words, char **environment)
{
    layer_begin();
    layer_is_armed = true;
    return real_main(n, words, environment);
}

typedef int start_function(int (*)(int, char **, char **), int, char **, void (*)(void), void (*)(void), void (*)(void),
                           void *);

/** The C library calls main here, after all that runs before it. */
// NOLINTNEXTLINE(bugprone-reserved-identifier)
int __libc_start_main(int (*main)(int, char **, char **), int n, char **words, void (*init)(void), void (*fini)(void),
                      void (*loader_fini)(void), void *stack_end)
{
    start_function *start;
    layer_next("__libc_start_main", &start);
    real_main = main;
    return start(begin, n, words, init, fini, loader_fini, stack_end);
}
