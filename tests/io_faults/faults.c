/* The k-th call of one kind fails, as if the system had refused it. What fails is told by the environment:
 *
 *   LAYER_FOLDER    only calls about files in this folder, sockets, and memory
 *   FAULTS_STATE    file of 64 kB that all processes share: what was called how often, and whether something has failed
 *   FAULTS_KIND     write, fsync, rename, ...; nothing fails if it is not there, calls are counted only
 *   FAULTS_PROCESS  its number: 0 is the first, children count on as they are made
 *   FAULTS_AT       number of the call of this kind in this process, from 1
 *   FAULTS_ERROR    number of the error; 0: half is written, and what follows finds the disk full; -1: half is written once
 *   FAULTS_ON       all calls from there on fail, also those of processes that are made later
 *   FAULTS_ORPHAN   the parent is killed before a process asks to die with it */
#define _GNU_SOURCE // NOLINT(bugprone-reserved-identifier)
#include "layer.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <unistd.h>

/** The runner reads the counts in this order. */
enum { WRITE, FSYNC, RENAME, OPEN, CLOSE, TRUNCATE, MMAP, MALLOC, READ, LINK, FORK, LOCK, N_KINDS };
static const char *const kinds[N_KINDS] = {"write", "fsync",  "rename", "open", "close", "truncate",
                                           "mmap",  "malloc", "read",   "link", "fork",  "lock"};
enum { MOST_PROCESSES = 64, STATE_BYTES = 65536 };

typedef struct {
    atomic_int n_processes, has_failed;
    atomic_long counts[MOST_PROCESSES][N_KINDS];
} shared;
_Static_assert(sizeof(shared) <= STATE_BYTES, "the runner makes a file of this size");

static shared *state;
static int self;
static struct {
    int kind, process, error;
    long at;
    bool is_lasting;
} requested = {.kind = -1};

static long number_of(const char *name)
{
    const char *text = layer_setting(name);
    return text == NULL ? 0 : strtol(text, NULL, 10);
}

static void new_process(int number)
{
    self = number < MOST_PROCESSES ? number : MOST_PROCESSES - 1;
}

void layer_begin(void)
{
    const char *path = layer_setting("FAULTS_STATE"), *kind = layer_setting("FAULTS_KIND");
    const int descriptor = path == NULL ? -1 : (int)syscall(SYS_openat, AT_FDCWD, path, O_RDWR | O_CLOEXEC);
    void *memory =
        (void *)syscall(SYS_mmap, NULL, STATE_BYTES, PROT_READ | PROT_WRITE, MAP_SHARED, descriptor, 0); // NOLINT
    (void)syscall(SYS_close, descriptor);
    if (memory == MAP_FAILED) {
        abort();
    }
    state = memory;
    new_process(atomic_fetch_add(&state->n_processes, 1));
    for (int i = 0; i < N_KINDS && kind != NULL; i++) {
        requested.kind = strcmp(kind, kinds[i]) == 0 ? i : requested.kind;
    }
    requested.process = (int)number_of("FAULTS_PROCESS");
    requested.at = number_of("FAULTS_AT");
    requested.error = (int)number_of("FAULTS_ERROR");
    requested.is_lasting = number_of("FAULTS_ON") != 0;
    layer_take_streams();
}

/** Count a call. @return whether it is to fail; errno says how */
static bool fails(int kind)
{
    if (!layer_is_armed) {
        return false;
    }
    const long number = atomic_fetch_add(&state->counts[self][kind], 1) + 1;
    const bool is_half = requested.error <= 0;
    if (kind != requested.kind) {
        return false;
    }
    const bool is_it = self == requested.process && number == requested.at;
    const bool is_after =
        (requested.is_lasting || requested.error == 0) && !is_it && atomic_load(&state->has_failed) != 0;
    if (is_it) {
        atomic_store(&state->has_failed, 1);
    }
    if (is_it || is_after) {
        errno = is_half ? (is_it ? 0 : ENOSPC) : requested.error;
    }
    return is_it || is_after;
}

/* ---- writing and reading ---- */

static bool is_ours(int descriptor)
{
    return layer_is_armed && (layer_owns(descriptor) || layer_is_socket(descriptor));
}

ssize_t write(int descriptor, const void *bytes, size_t n)
{
    if (is_ours(descriptor) && fails(WRITE)) {
        return errno != 0 ? -1 : syscall(SYS_write, descriptor, bytes, (n + 1) / 2);
    }
    return syscall(SYS_write, descriptor, bytes, n);
}

ssize_t pwrite(int descriptor, const void *bytes, size_t n, off_t offset)
{
    if (is_ours(descriptor) && fails(WRITE)) {
        return errno != 0 ? -1 : syscall(SYS_pwrite64, descriptor, bytes, (n + 1) / 2, offset);
    }
    return syscall(SYS_pwrite64, descriptor, bytes, n, offset);
}

ssize_t pwrite64(int descriptor, const void *bytes, size_t n, off64_t offset)
{
    return pwrite(descriptor, bytes, n, offset);
}

static bool reading_fails(int descriptor)
{
    return is_ours(descriptor) && fails(READ) && errno != 0;
}

ssize_t read(int descriptor, void *bytes, size_t n)
{
    return reading_fails(descriptor) ? -1 : syscall(SYS_read, descriptor, bytes, n);
}

ssize_t pread(int descriptor, void *bytes, size_t n, off_t offset)
{
    return reading_fails(descriptor) ? -1 : syscall(SYS_pread64, descriptor, bytes, n, offset);
}

ssize_t pread64(int descriptor, void *bytes, size_t n, off64_t offset)
{
    return pread(descriptor, bytes, n, offset);
}

ssize_t recv(int descriptor, void *bytes, size_t n, int flags)
{
    return reading_fails(descriptor) ? -1 : syscall(SYS_recvfrom, descriptor, bytes, n, flags, NULL, NULL);
}

int ftruncate(int descriptor, off_t length)
{
    return is_ours(descriptor) && fails(TRUNCATE) ? -1 : (int)syscall(SYS_ftruncate, descriptor, length);
}

int ftruncate64(int descriptor, off64_t length)
{
    return ftruncate(descriptor, length);
}

int fsync(int descriptor)
{
    return is_ours(descriptor) && fails(FSYNC) ? -1 : (int)syscall(SYS_fsync, descriptor);
}

int fdatasync(int descriptor)
{
    return is_ours(descriptor) && fails(FSYNC) ? -1 : (int)syscall(SYS_fdatasync, descriptor);
}

/* ---- names ---- */

static bool is_path_ours(int folder, const char *path)
{
    return layer_is_armed && layer_owns_path(folder, path);
}

static int open_at(int folder, const char *path, int flags, mode_t mode)
{
    return is_path_ours(folder, path) && fails(OPEN) ? -1 : (int)syscall(SYS_openat, folder, path, flags, mode);
}

#define MODE_OF(flags)                                                                                                 \
    va_list arguments;                                                                                                 \
    va_start(arguments, flags);                                                                                        \
    const mode_t mode = ((flags) & (O_CREAT | O_TMPFILE)) != 0 ? va_arg(arguments, mode_t) : 0;                        \
    va_end(arguments)

int open(const char *path, int flags, ...)
{
    MODE_OF(flags);
    return open_at(AT_FDCWD, path, flags, mode);
}

int open64(const char *path, int flags, ...)
{
    MODE_OF(flags);
    return open_at(AT_FDCWD, path, flags, mode);
}

int openat(int folder, const char *path, int flags, ...)
{
    MODE_OF(flags);
    return open_at(folder, path, flags, mode);
}

int openat64(int folder, const char *path, int flags, ...)
{
    MODE_OF(flags);
    return open_at(folder, path, flags, mode);
}

int mkstemp(char *pattern)
{
    int (*next)(char *);
    layer_next("mkstemp", &next);
    return is_path_ours(AT_FDCWD, pattern) && fails(OPEN) ? -1 : next(pattern);
}

FILE *fopen(const char *path, const char *mode)
{
    if (!is_path_ours(AT_FDCWD, path)) {
        FILE *(*next)(const char *, const char *);
        layer_next("fopen", &next);
        return next(path, mode);
    }
    const int flags = mode[0] == 'r'   ? O_RDONLY
                      : mode[0] == 'w' ? O_WRONLY | O_CREAT | O_TRUNC
                                       : O_WRONLY | O_CREAT | O_APPEND;
    const int descriptor = open(path, flags | O_CLOEXEC, 0666);
    return descriptor < 0 ? NULL : layer_stream(descriptor, mode);
}

FILE *fopen64(const char *path, const char *mode)
{
    return fopen(path, mode);
}

DIR *opendir(const char *path)
{
    DIR *(*next)(const char *);
    layer_next("opendir", &next);
    return is_path_ours(AT_FDCWD, path) && fails(OPEN) ? NULL : next(path);
}

/** What fails has closed it all the same, as systems do. */
int close(int descriptor)
{
    const bool is_bad = is_ours(descriptor) && fails(CLOSE);
    const int reason = errno, result = (int)syscall(SYS_close, descriptor);
    errno = is_bad ? reason : errno;
    return is_bad ? -1 : result;
}

int renameat(int from, const char *old, int to, const char *new)
{
    return is_path_ours(to, new) && fails(RENAME) ? -1 : (int)syscall(SYS_renameat2, from, old, to, new, 0);
}

int rename(const char *old, const char *new)
{
    return renameat(AT_FDCWD, old, AT_FDCWD, new);
}

int link(const char *old, const char *new)
{
    return is_path_ours(AT_FDCWD, new) && fails(LINK) ? -1 : (int)syscall(SYS_linkat, AT_FDCWD, old, AT_FDCWD, new, 0);
}

int mkdir(const char *path, mode_t mode)
{
    return is_path_ours(AT_FDCWD, path) && fails(LINK) ? -1 : (int)syscall(SYS_mkdirat, AT_FDCWD, path, mode);
}

/* ---- locks ---- */

int flock(int descriptor, int operation)
{
    return is_ours(descriptor) && fails(LOCK) ? -1 : (int)syscall(SYS_flock, descriptor, operation);
}

int fcntl(int descriptor, int command, ...)
{
    va_list arguments;
    va_start(arguments, command);
    void *const argument = va_arg(arguments, void *);
    va_end(arguments);
    return command == F_SETLK && is_ours(descriptor) && fails(LOCK)
               ? -1
               : (int)syscall(SYS_fcntl, descriptor, command, argument);
}

int fcntl64(int descriptor, int command, ...)
{
    va_list arguments;
    va_start(arguments, command);
    void *const argument = va_arg(arguments, void *);
    va_end(arguments);
    return fcntl(descriptor, command, argument);
}

/* ---- processes ---- */

pid_t fork(void)
{
    pid_t (*next)(void);
    layer_next("fork", &next);
    if (fails(FORK)) {
        return -1;
    }
    const int child = layer_is_armed ? atomic_fetch_add(&state->n_processes, 1) : 0;
    const pid_t pid = next();
    if (pid == 0 && layer_is_armed) {
        new_process(child);
    }
    return pid;
}

/** Asked for in time, a process dies with its parent; here the parent is dead by then. */
int prctl(int option, ...)
{
    va_list arguments;
    va_start(arguments, option);
    const unsigned long argument = va_arg(arguments, unsigned long);
    va_end(arguments);
    const pid_t parent = getppid();
    if (option == PR_SET_PDEATHSIG && layer_setting("FAULTS_ORPHAN") != NULL) {
        (void)kill(parent, SIGKILL);
        while (getppid() == parent) {
            (void)usleep(1000);
        }
    }
    return (int)syscall(SYS_prctl, option, argument, 0, 0, 0);
}

int socketpair(int domain, int type, int protocol, int ends[2])
{
    return fails(FORK) ? -1 : (int)syscall(SYS_socketpair, domain, type, protocol, ends);
}

/* ---- memory ---- */

void *__libc_malloc(size_t size);                // NOLINT(bugprone-reserved-identifier)
void *__libc_calloc(size_t count, size_t size);  // NOLINT(bugprone-reserved-identifier)
void *__libc_realloc(void *old, size_t size);    // NOLINT(bugprone-reserved-identifier)
void *__libc_memalign(size_t line, size_t size); // NOLINT(bugprone-reserved-identifier)

static bool memory_fails(void)
{
    return layer_is_armed && fails(MALLOC);
}

void *malloc(size_t size)
{
    return memory_fails() ? NULL : __libc_malloc(size);
}

void *calloc(size_t count, size_t size)
{
    return memory_fails() ? NULL : __libc_calloc(count, size);
}

void *realloc(void *old, size_t size)
{
    return memory_fails() ? NULL : __libc_realloc(old, size);
}

void *aligned_alloc(size_t line, size_t size)
{
    return memory_fails() ? NULL : __libc_memalign(line, size);
}

int posix_memalign(void **memory, size_t line, size_t size)
{
    *memory = memory_fails() ? NULL : __libc_memalign(line, size);
    return *memory == NULL ? ENOMEM : 0;
}

void *mmap(void *address, size_t size, int protection, int flags, int descriptor, off_t offset)
{
    if (layer_is_armed && fails(MMAP)) {
        return MAP_FAILED;
    }
    return (void *)syscall(SYS_mmap, address, size, protection, flags, descriptor, offset); // NOLINT
}

void *mmap64(void *address, size_t size, int protection, int flags, int descriptor, off64_t offset)
{
    return mmap(address, size, protection, flags, descriptor, offset);
}
