/* What would be on the disk if the power went now: the store has of each file what was last brought to the disk, and of each folder
 * the names that it had then. Names and contents that nobody has synced are not there. The environment tells
 *
 *   LAYER_FOLDER  the folder that loses what is not synced
 *   POWER_STORE   a folder for what is on the disk; it has to be outside
 *   POWER_WORD    the power goes as soon as a line with this word was written to standard output or error
 *   POWER_AT      at the how manieth such line, from 1
 *   POWER_CLOCK   how many times as fast the clock goes */
#define _GNU_SOURCE // NOLINT(bugprone-reserved-identifier)
#include "layer.h"

#include <dirent.h>
#include <fcntl.h>
#include <limits.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <time.h>
#include <unistd.h>

static pid_t first; /* process, whose end is the loss of power */
static long n_lines;

void layer_begin(void)
{
    first = getpid();
    layer_take_streams();
}

/* ---- the store ---- */

/** Files are known by their number and by when they were made: numbers are given again. */
static void name_in_store(const struct statx *file, const char *ending, char path[PATH_MAX])
{
    (void)snprintf(path, PATH_MAX, "%s/%llu-%lld-%u%s", layer_setting("POWER_STORE"), (unsigned long long)file->stx_ino,
                   (long long)file->stx_btime.tv_sec, file->stx_btime.tv_nsec, ending);
}

static bool look(int folder, const char *name, struct statx *file)
{
    const int flags = name[0] == '\0' ? AT_EMPTY_PATH : AT_SYMLINK_NOFOLLOW;
    return statx(folder, name, flags, STATX_BASIC_STATS | STATX_BTIME, file) == 0;
}

/** All of a file, or nothing, takes its place in the store. */
static void keep_content(int descriptor, const struct statx *file)
{
    char path[PATH_MAX], partial[PATH_MAX], bytes[65536];
    name_in_store(file, "", path);
    (void)snprintf(partial, sizeof partial, "%.4000s.%d", path, getpid());
    const int to = (int)syscall(SYS_openat, AT_FDCWD, partial, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
    char link[64];
    (void)snprintf(link, sizeof link, "/proc/self/fd/%d", descriptor); /* it may be open for writing only */
    const int from = (int)syscall(SYS_openat, AT_FDCWD, link, O_RDONLY | O_CLOEXEC);
    for (ssize_t n = read(from, bytes, sizeof bytes); n > 0; n = read(from, bytes, sizeof bytes)) {
        if (syscall(SYS_write, to, bytes, (size_t)n) != n) {
            abort();
        }
    }
    (void)close(from);
    (void)close(to);
    (void)rename(partial, path);
}

/** The folder of the test itself is where all begins. */
static void keep_root(const struct statx *folder, const char *path)
{
    struct statx root;
    char name[PATH_MAX];
    (void)snprintf(name, sizeof name, "%s/root", layer_setting("POWER_STORE"));
    if (look(AT_FDCWD, layer_setting("LAYER_FOLDER"), &root) && root.stx_ino == folder->stx_ino) {
        (void)!symlink(strrchr(path, '/') + 1, name); /* it may be there already */
    }
}

/** A line for each name: a folder or not, what it is in the store, its name. */
static void keep_names(int descriptor, const struct statx *folder)
{
    char path[PATH_MAX], partial[PATH_MAX], link[64];
    name_in_store(folder, ".names", path);
    (void)snprintf(partial, sizeof partial, "%.4000s.%d", path, getpid());
    (void)snprintf(link, sizeof link, "/proc/self/fd/%d", descriptor);
    FILE *list = fopen(partial, "w");
    DIR *names = opendir(link);
    if (list == NULL || names == NULL) {
        abort();
    }
    for (const struct dirent *entry = readdir(names); entry != NULL; entry = readdir(names)) {
        struct statx file;
        char stored[PATH_MAX];
        if (strcmp(entry->d_name, ".") != 0 && strcmp(entry->d_name, "..") != 0 &&
            look(descriptor, entry->d_name, &file)) {
            name_in_store(&file, "", stored);
            fprintf(list, "%c %s %s\n", S_ISDIR(file.stx_mode) ? 'd' : 'f', strrchr(stored, '/') + 1, entry->d_name);
        }
    }
    (void)closedir(names);
    (void)fclose(list);
    (void)rename(partial, path);
    keep_root(folder, path);
}

/** A line for each time that something was brought to the disk. */
static void keep_count(void)
{
    char path[PATH_MAX];
    (void)snprintf(path, sizeof path, "%s/syncs", layer_setting("POWER_STORE"));
    const int log = (int)syscall(SYS_openat, AT_FDCWD, path, O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
    (void)!syscall(SYS_write, log, "\n", 1);
    (void)close(log);
}

static int sync_file(int descriptor, long call)
{
    struct statx file;
    const int result = (int)syscall(call, descriptor);
    if (result == 0 && layer_is_armed && layer_owns(descriptor) && look(descriptor, "", &file)) {
        (S_ISDIR(file.stx_mode) ? keep_names : keep_content)(descriptor, &file);
        keep_count();
    }
    return result;
}

int fsync(int descriptor)
{
    return sync_file(descriptor, SYS_fsync);
}

int fdatasync(int descriptor)
{
    return sync_file(descriptor, SYS_fdatasync);
}

/* ---- the loss ---- */

/** The machine is gone, and with it all processes: the layer has no others to wait for. */
static void count_lines(int descriptor, const char *bytes, size_t n)
{
    const char *word = layer_setting("POWER_WORD"), *at = layer_setting("POWER_AT");
    if (!layer_is_armed || word == NULL || (descriptor != STDOUT_FILENO && descriptor != STDERR_FILENO)) {
        return;
    }
    if (memmem(bytes, n, word, strlen(word)) != NULL && ++n_lines == (at == NULL ? 1 : strtol(at, NULL, 10))) {
        (void)kill(first, SIGKILL);
        (void)pause();
    }
}

ssize_t write(int descriptor, const void *bytes, size_t n)
{
    const ssize_t done = syscall(SYS_write, descriptor, bytes, n);
    if (done > 0) {
        count_lines(descriptor, bytes, (size_t)done);
    }
    return done;
}

/* ---- the clock ---- */

int clock_gettime(clockid_t clock, struct timespec *now)
{
    static struct timespec start;
    const char *speed = layer_setting("POWER_CLOCK");
    const int result = (int)syscall(SYS_clock_gettime, clock, now);
    if (clock != CLOCK_MONOTONIC || speed == NULL) {
        return result;
    }
    if (start.tv_sec == 0) {
        start = *now;
    }
    const double passed = (double)(now->tv_sec - start.tv_sec) + 1e-9 * (double)(now->tv_nsec - start.tv_nsec);
    const double shown = passed * strtod(speed, NULL);
    now->tv_sec = start.tv_sec + (time_t)shown;
    now->tv_nsec = (long)(1e9 * (shown - (double)(time_t)shown));
    return result;
}
