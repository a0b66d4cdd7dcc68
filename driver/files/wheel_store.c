#include "files/wheel_store.h"

#include "base/memory.h"
#include "files/wheel_file.h"

#include <dirent.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

/** Limit of wheels in memory, since a sweep over the geometry may have any number of them. */
enum { MAX_STORED = 1000 };

struct wheel_store {
    evl_wheel_store door;
    char *folder;                     /**< NULL: none */
    wheel_numbers stored[MAX_STORED]; /**< one array contains the numbers of a wheel, followed by its key */
    long n_met, n_computed;           /**< wheel number i is stored at i mod MAX_STORED */
    evl_error error;
};

/* ---- in memory ---- */

static long n_stored(const wheel_store *store)
{
    return store->n_met < MAX_STORED ? store->n_met : MAX_STORED;
}

static bool recall(const wheel_store *store, const wheel_numbers *wheel)
{
    const size_t size = (size_t)wheel->n_key * sizeof *wheel->key;
    for (long i = 0; i < n_stored(store); i++) {
        const wheel_numbers *stored = &store->stored[i];
        if (stored->n_key == wheel->n_key && stored->n == wheel->n && memcmp(stored->key, wheel->key, size) == 0) {
            memcpy(wheel->numbers, stored->numbers, (size_t)wheel->n * sizeof *wheel->numbers);
            return true;
        }
    }
    return false;
}

static void remember(wheel_store *store, const wheel_numbers *wheel)
{
    wheel_numbers *stored = &store->stored[store->n_met++ % MAX_STORED];
    double *numbers = xrealloc(stored->numbers, (size_t)wheel->n_key + (size_t)wheel->n, sizeof *numbers);
    double *key = memcpy(numbers + wheel->n, wheel->key, (size_t)wheel->n_key * sizeof *key);
    memcpy(numbers, wheel->numbers, (size_t)wheel->n * sizeof *numbers);
    *stored = (wheel_numbers){.n_key = wheel->n_key, .n = wheel->n, .key = key, .numbers = numbers};
}

/* ---- in the folder ---- */

static char *path_of(const wheel_store *store, const wheel_numbers *wheel)
{
    return xasprintf("%s/compliance-%016llx.h5", store->folder, wheel_file_hash(wheel));
}

/** Whether a name is that of a temporary file, compliance-HASH.h5.XXXXXX. */
static bool is_partial(const char *name)
{
    static const char begin[] = "compliance-", end[] = ".h5.";
    enum { BEGIN = sizeof begin - 1, HASH = 16, END = sizeof end - 1, REST = 6 };
    return strlen(name) == BEGIN + HASH + END + REST && strncmp(name, begin, BEGIN) == 0 &&
           strspn(name + BEGIN, "0123456789abcdef") == HASH && strncmp(name + BEGIN + HASH, end, END) == 0;
}

/** Delete the temporary files of killed writers. Writing takes milliseconds: an old one has no writer. */
static void drop_leftovers(const char *folder)
{
    enum { OLD = 600 }; /* [s] */
    DIR *stream = opendir(folder);
    if (stream == NULL) {
        return;
    }
    for (const struct dirent *entry = readdir(stream); entry != NULL; entry = readdir(stream)) {
        struct stat status;
        CLEANUP_FREE char *path = xasprintf("%s/%s", folder, entry->d_name);
        if (is_partial(entry->d_name) && lstat(path, &status) == 0 && difftime(time(NULL), status.st_mtime) > OLD) {
            (void)unlink(path);
        }
    }
    (void)closedir(stream);
}

/** Write a wheel and read it again: the file is used, whichever process wrote it. @return 1 or -1 */
static int settle(wheel_store *store, const wheel_numbers *wheel)
{
    CLEANUP_FREE char *path = path_of(store, wheel);
    return wheel_file_write(path, wheel, &store->error) &&
                   wheel_file_read(path, wheel, &store->error) == WHEEL_FILE_READ
               ? 1
               : -1;
}

/* ---- interface for the model ---- */

static int find(void *self, int n_key, const double *key, int n, double *numbers)
{
    wheel_store *store = self;
    const wheel_numbers wheel = {.n_key = n_key, .key = key, .n = n, .numbers = numbers};
    if (recall(store, &wheel)) {
        return 1;
    }
    if (store->folder == NULL) {
        return 0;
    }
    CLEANUP_FREE char *path = path_of(store, &wheel);
    const wheel_file_status status = wheel_file_read(path, &wheel, &store->error);
    if (status == WHEEL_FILE_READ) {
        remember(store, &wheel);
    }
    return status == WHEEL_FILE_READ ? 1 : status == WHEEL_FILE_MISSING ? 0 : -1;
}

static int put(void *self, int n_key, const double *key, int n, double *numbers)
{
    wheel_store *store = self;
    const wheel_numbers wheel = {.n_key = n_key, .key = key, .n = n, .numbers = numbers};
    store->n_computed++;
    if (store->folder != NULL && settle(store, &wheel) < 0) {
        return -1;
    }
    remember(store, &wheel);
    return 1;
}

wheel_store *wheel_store_create(void)
{
    wheel_store *store = xcalloc(1, sizeof *store);
    store->door = (evl_wheel_store){.self = store, .find = find, .put = put};
    return store;
}

void wheel_store_delete(wheel_store **pointer)
{
    wheel_store *store = *pointer;
    *pointer = NULL;
    if (store == NULL) {
        return;
    }
    for (long i = 0; i < n_stored(store); i++) {
        free(store->stored[i].numbers);
    }
    free(store->folder);
    free(store);
}

bool wheel_store_share(wheel_store *store, const char *folder, evl_error *error)
{
    store->folder = xstrdup(folder);
    drop_leftovers(folder);
    for (long i = 0; i < n_stored(store); i++) {
        if (settle(store, &store->stored[i]) < 0) {
            *error = store->error;
            return false;
        }
    }
    return true;
}

const evl_wheel_store *wheel_store_door(const wheel_store *store)
{
    return &store->door;
}

long wheel_store_computed(const wheel_store *store)
{
    return store->n_computed;
}

const evl_error *wheel_store_error(const wheel_store *store)
{
    return &store->error;
}
