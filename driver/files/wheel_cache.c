#include "files/wheel_cache.h"

#include "base/crc32.h"
#include "base/memory.h"
#include "base/write_bytes.h"

#include <dirent.h>
#include <evolvent_compliance_sources.h>
#include <fcntl.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static const long long most_bytes = 64LL << 20, retained_bytes = 48LL << 20;
static const char prefix[] = "wheel-";

struct wheel_cache {
    evl_wheel_store store;
    char *folder; /**< NULL: none */
};

/** Header of a file; followed by the key, the numbers and the checksum of all preceding bytes. */
typedef struct {
    char magic[8];
    char sources[56]; /**< identification of the program's sources */
    int64_t n_key, n;
} front;

/* ---- the folder ---- */

static char *find_folder(void)
{
    const char *own = getenv("EVOLVENT_CACHE"), *cache = getenv("XDG_CACHE_HOME"), *home = getenv("HOME");
    if (own != NULL && own[0] != '\0') {
        return strcmp(own, "off") == 0 ? NULL : xstrdup(own);
    }
    if (cache != NULL && cache[0] == '/') {
        return xasprintf("%s/evolvent", cache);
    }
    return home != NULL && home[0] == '/' ? xasprintf("%s/.cache/evolvent", home) : NULL;
}

/** Create a folder and its parent. */
static void make_folder(const char *folder)
{
    CLEANUP_FREE char *parent = xstrdup(folder);
    char *slash = strrchr(parent, '/');
    if (slash != NULL && slash != parent) {
        *slash = '\0';
        (void)mkdir(parent, 0700);
    }
    (void)mkdir(folder, 0700);
}

static bool is_of_cache(const char *name)
{
    return strncmp(name, prefix, sizeof prefix - 1) == 0;
}

typedef struct {
    char *path;
    long long size;
    struct timespec used;
} cached;

static int compare_use(const void *a, const void *b)
{
    const struct timespec *x = &((const cached *)a)->used, *y = &((const cached *)b)->used;
    const int seconds = (x->tv_sec > y->tv_sec) - (x->tv_sec < y->tv_sec);
    return seconds != 0 ? seconds : (x->tv_nsec > y->tv_nsec) - (x->tv_nsec < y->tv_nsec);
}

/** List all files of the cache. @return their number; their bytes in `total` */
static size_t list_files(memory_arena *arena, const char *folder, cached **files, long long *total)
{
    size_t n = 0, capacity = 64;
    DIR *stream = opendir(folder);
    *files = arena_calloc(arena, capacity, sizeof **files);
    *total = 0;
    if (stream == NULL) {
        return 0;
    }
    for (const struct dirent *entry = readdir(stream); entry != NULL; entry = readdir(stream)) {
        struct stat status;
        char *path = is_of_cache(entry->d_name) ? arena_printf(arena, "%s/%s", folder, entry->d_name) : NULL;
        if (path == NULL || lstat(path, &status) != 0 || !S_ISREG(status.st_mode)) {
            continue;
        }
        if (n == capacity) {
            *files = arena_grow(arena, *files, capacity, 2 * capacity, sizeof **files);
            capacity *= 2;
        }
        (*files)[n++] = (cached){path, (long long)status.st_size, status.st_mtim};
        *total += (long long)status.st_size;
    }
    (void)closedir(stream);
    return n;
}

/** Delete the least recently used files if the size limit is exceeded. */
static void bound_folder(const char *folder)
{
    ARENA_SCOPE memory_arena arena = {NULL};
    cached *files;
    long long total;
    const size_t n = list_files(&arena, folder, &files, &total);
    if (total <= most_bytes) {
        return;
    }
    qsort(files, n, sizeof *files, compare_use);
    for (size_t i = 0; i < n && total > retained_bytes; i++) {
        (void)unlink(files[i].path);
        total -= files[i].size;
    }
}

/* ---- a file ---- */

/** FNV-1a over the sources and the key. */
static char *path_of(const wheel_cache *cache, int n_key, const double *key)
{
    uint64_t hash = 0xcbf29ce484222325ULL;
    for (const char *c = EVOLVENT_COMPLIANCE_SOURCES; *c != '\0'; c++) {
        hash = (hash ^ (unsigned char)*c) * 0x100000001b3ULL;
    }
    const unsigned char *bytes = (const unsigned char *)key;
    for (size_t i = 0; i < (size_t)n_key * sizeof *key; i++) {
        hash = (hash ^ bytes[i]) * 0x100000001b3ULL;
    }
    return xasprintf("%s/%s%016llx", cache->folder, prefix, (unsigned long long)hash);
}

static front front_of(int n_key, int n)
{
    front begin = {.magic = "evlwheel", .n_key = n_key, .n = n};
    (void)snprintf(begin.sources, sizeof begin.sources, "%s", EVOLVENT_COMPLIANCE_SOURCES);
    return begin;
}

/** Bytes of a file without its checksum. */
static size_t size_of(int n_key, int n)
{
    return sizeof(front) + ((size_t)n_key + (size_t)n) * sizeof(double);
}

/** Read a file of the given size. @return NULL if the size differs, or it cannot be read */
static char *read_file(const char *path, size_t size)
{
    const int descriptor = open(path, O_RDONLY | O_CLOEXEC | O_NOFOLLOW);
    if (descriptor < 0) {
        return NULL;
    }
    struct stat status;
    char *bytes = NULL;
    if (fstat(descriptor, &status) == 0 && S_ISREG(status.st_mode) && (size_t)status.st_size == size) {
        bytes = xcalloc(size, 1);
        size_t got = 0;
        for (ssize_t more = 1; got < size && more > 0; got += more > 0 ? (size_t)more : 0) {
            more = read(descriptor, bytes + got, size - got);
        }
        if (got < size) {
            free(bytes);
            bytes = NULL;
        }
    }
    (void)close(descriptor);
    return bytes;
}

static int find(void *self, int n_key, const double *key, int n, double *numbers)
{
    const wheel_cache *cache = self;
    const size_t size = size_of(n_key, n), key_size = (size_t)n_key * sizeof *key;
    const front begin = front_of(n_key, n);
    uint32_t check;
    CLEANUP_FREE char *path = path_of(cache, n_key, key);
    CLEANUP_FREE char *bytes = read_file(path, size + sizeof check);
    if (bytes == NULL) {
        return 0;
    }
    memcpy(&check, bytes + size, sizeof check);
    if (check != crc32_on(0, bytes, size) || memcmp(bytes, &begin, sizeof begin) != 0 ||
        memcmp(bytes + sizeof begin, key, key_size) != 0) {
        return 0;
    }
    memcpy(numbers, bytes + sizeof begin + key_size, (size_t)n * sizeof *numbers);
    (void)utimensat(AT_FDCWD, path, NULL, 0); /* updates the time of last use */
    return 1;
}

/** Write to a temporary file and rename it: however the program ends, a file with the final name is complete. */
static void write_file(const char *path, const char *bytes, size_t size)
{
    CLEANUP_FREE char *partial = xasprintf("%s.XXXXXX", path);
    const int descriptor = mkstemp(partial);
    if (descriptor < 0) {
        return;
    }
    const bool good = write_bytes(descriptor, -1, bytes, size) == size;
    if (close(descriptor) != 0 || !good || rename(partial, path) != 0) {
        (void)unlink(partial);
    }
}

static int put(void *self, int n_key, const double *key, int n, double *numbers)
{
    const wheel_cache *cache = self;
    const size_t size = size_of(n_key, n), key_size = (size_t)n_key * sizeof *key;
    const front begin = front_of(n_key, n);
    CLEANUP_FREE char *path = path_of(cache, n_key, key);
    CLEANUP_FREE char *bytes = xcalloc(size + sizeof(uint32_t), 1);
    memcpy(bytes, &begin, sizeof begin);
    memcpy(bytes + sizeof begin, key, key_size);
    memcpy(bytes + sizeof begin + key_size, numbers, (size_t)n * sizeof *numbers);
    const uint32_t check = crc32_on(0, bytes, size);
    memcpy(bytes + size, &check, sizeof check);
    make_folder(cache->folder);
    write_file(path, bytes, size + sizeof check);
    bound_folder(cache->folder);
    return 1;
}

/* ---- public procedures ---- */

wheel_cache *wheel_cache_open(void)
{
    wheel_cache *cache = xcalloc(1, sizeof *cache);
    cache->folder = find_folder();
    cache->store = (evl_wheel_store){.self = cache, .find = find, .put = put};
    return cache;
}

void wheel_cache_close(wheel_cache **cache)
{
    if (*cache != NULL) {
        free((*cache)->folder);
        free(*cache);
        *cache = NULL;
    }
}

const evl_wheel_store *wheel_cache_store(const wheel_cache *cache)
{
    return cache->folder == NULL ? NULL : &cache->store;
}
