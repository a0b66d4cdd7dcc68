#include "commands/result.h"

#include "base/memory.h"
#include "files/history.h"
#include "integrate/integrate.h"

#include <evolvent_version.h>
#include <string.h>
#include <sys/stat.h>

char *result_path(const char *given, const char *case_path, const char *suffix)
{
    const char *slash = strrchr(case_path, '/');
    const char *name = slash == NULL ? case_path : slash + 1;
    const char *dot = strrchr(name, '.');
    const size_t length = dot == NULL || dot == name ? strlen(name) : (size_t)(dot - name);
    return given != NULL ? xstrdup(given) : xasprintf("%.*s%s.h5", (int)length, name, suffix);
}

bool result_spares_case(const char *what, const char *path, const char *case_path, evl_error *error)
{
    struct stat first, second;
    const bool is_same = stat(path, &first) == 0 && stat(case_path, &second) == 0 && first.st_dev == second.st_dev &&
                         first.st_ino == second.st_ino;
    return !is_same || evl_error_set(error, EVL_EXIT_USAGE, "",
                                     "the %s would replace the case '%s'; name another file with -o", what, path);
}

char *result_versions(void)
{
    return xasprintf("evolvent %s, %s, %s, C compiler %s, Fortran compiler %s", EVOLVENT_VERSION, integrate_version(),
                     history_version(), EVOLVENT_C_COMPILER, model_tables()->compiler);
}
