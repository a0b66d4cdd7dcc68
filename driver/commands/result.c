#include "commands/result.h"

#include "base/memory.h"

#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/** Whether a path is that of the case file, also if that is read from standard input. */
static bool is_case(const char *path, const char *case_path, bool by_input)
{
    struct stat first, second;
    return stat(path, &first) == 0 && (by_input ? fstat(STDIN_FILENO, &second) : stat(case_path, &second)) == 0 &&
           S_ISREG(first.st_mode) && first.st_dev == second.st_dev && first.st_ino == second.st_ino;
}

/** The case's name with the suffix. */
static char *path_of_case(const char *case_path, const char *suffix)
{
    const char *slash = strrchr(case_path, '/');
    const char *name = slash == NULL ? case_path : slash + 1;
    const char *dot = strrchr(name, '.');
    const size_t length = dot == NULL || dot == name ? strlen(name) : (size_t)(dot - name);
    return xasprintf("%.*s%s", (int)length, name, suffix);
}

char *result_path(const char *what, const char *given, const char *case_path, const char *suffix, evl_error *error)
{
    const bool by_input = strcmp(case_path, "-") == 0;
    if (given == NULL && by_input) {
        (void)evl_error_set(error, EVL_EXIT_USAGE, "",
                            "a case from standard input has no name for the %s; name a file with -o", what);
        return NULL;
    }
    char *path = given != NULL ? xstrdup(given) : path_of_case(case_path, suffix);
    if (is_case(path, case_path, by_input)) {
        (void)evl_error_set(error, EVL_EXIT_USAGE, "", "the %s would replace the case '%s'; name another file with -o",
                            what, path);
        free(path);
        return NULL;
    }
    return path;
}
