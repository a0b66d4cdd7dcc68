/* Binary of an FMU, and the libraries required next to it. */
#include "base/memory.h"
#include "base/words.h"
#include "fmu/fmu_write.h"

#include <errno.h>
#include <link.h>
#include <string.h>
#include <unistd.h>

/** Location of the binary, as required by importers. */
static const char folder[] = "binaries/x86_64-linux";

typedef struct {
    memory_arena *arena;
    int n, n_names;
    fmu_file *files;
    char **names; /**< of libraries, without "lib" and suffix */
} search;

/** Whether a library has one of the names: libgfortran.so.5, or in a wheel libgfortran-1a2b3c.so.5. */
static bool is_bundled(const search *s, const char *base)
{
    if (strncmp(base, "lib", 3) != 0) {
        return false;
    }
    for (int i = 0; i < s->n_names; i++) {
        const size_t n = strlen(s->names[i]);
        if (strncmp(base + 3, s->names[i], n) == 0 && (base[3 + n] == '.' || base[3 + n] == '-')) {
            return true;
        }
    }
    return false;
}

static void add(search *s, const char *name, const char *path)
{
    s->files = arena_grow(s->arena, s->files, (size_t)s->n, (size_t)s->n + 1, sizeof *s->files);
    s->files[s->n++] = (fmu_file){arena_printf(s->arena, "%s/%s", folder, name), arena_copy(s->arena, path), NULL};
}

/** Callback for each library loaded by this program. */
static int look(struct dl_phdr_info *info, size_t size, void *with)
{
    search *s = with;
    const char *slash = info->dlpi_name == NULL ? NULL : strrchr(info->dlpi_name, '/');
    (void)size;
    if (slash != NULL && is_bundled(s, slash + 1)) {
        add(s, slash + 1, info->dlpi_name);
    }
    return 0;
}

/** Path of the binary, in this program's folder or in that of its libraries; NULL if it is in neither. */
static char *find_binary(memory_arena *arena)
{
    static const char *const folders[] = {"", FMU_FOLDER "/"};
    char own[4096];
    const ssize_t n = readlink("/proc/self/exe", own, sizeof own - 1);
    if (n <= 0) {
        return NULL;
    }
    own[n] = '\0';
    *(strrchr(own, '/') + 1) = '\0';
    for (size_t i = 0; i < sizeof folders / sizeof *folders; i++) {
        char *path = arena_printf(arena, "%s%s%s", own, folders[i], FMU_BINARY);
        if (access(path, R_OK) == 0) {
            return path;
        }
    }
    return NULL;
}

int fmu_binary(memory_arena *arena, fmu_file **files, evl_error *error)
{
    search s = {.arena = arena};
    const char *path = find_binary(arena);
    if (path == NULL) {
        (void)evl_error_set(error, EVL_EXIT_USAGE, FMU_BINARY,
                            "the binary for FMUs is neither next to the program nor in " FMU_FOLDER
                            " relative to it; install evolvent completely");
        return 0;
    }
    s.n_names = words_split(FMU_BUNDLED, &s.names);
    add(&s, FMU_MODEL_IDENTIFIER ".so", path);
    (void)dl_iterate_phdr(look, &s);
    free(s.names);
    *files = s.files;
    return s.n;
}
