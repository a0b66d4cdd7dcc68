#include "batch/batch_todo.h"

#include "base/memory.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

long batch_shard_size(const batch_plan *plan)
{
    const long n = plan->design->n_cases;
    return plan->first_case < n ? (n - 1 - plan->first_case) / plan->stride + 1 : 0;
}

static const char *skip_blanks(const char *text)
{
    while (*text == ' ' || *text == '\t' || *text == '\r' || *text == '\n') {
        text++;
    }
    return text;
}

/** Take the number of a line. @return false if it has none */
static bool take_line(const batch_plan *plan, const char *line, bool *is_wanted)
{
    char *end = NULL;
    const char *start = skip_blanks(line);
    if (*start == '\0') {
        return true;
    }
    errno = 0;
    const long index = strtol(start, &end, 10);
    if (end == start || *skip_blanks(end) != '\0' || errno != 0 || index < 0 || index >= plan->design->n_cases) {
        return false;
    }
    if (index % plan->stride == plan->first_case) { /* else it is another shard's */
        is_wanted[index] = true; /* NOLINT(clang-analyzer-security.ArrayBound): it is less than n_cases */
    }
    return true;
}

/** @param is_wanted  [n_cases] */
static bool read_cases(const batch_plan *plan, const char *path, bool *is_wanted, evl_error *error)
{
    enum { SHOWN = 40 }; /* characters of a bad line */
    FILE *file = fopen(path, "rb");
    char *line = NULL;
    size_t room = 0;
    long n_lines = 0;
    bool good = true;
    if (file == NULL) {
        return evl_error_set(error, EVL_EXIT_CASE, path, "cannot be read: %s", strerror(errno));
    }
    while (good && getline(&line, &room, file) > 0) {
        n_lines++;
        good = take_line(plan, line, is_wanted);
        if (!good) {
            OWNED char *place = xasprintf("%s:%ld", path, n_lines);
            const int length = (int)strcspn(line, "\r\n");
            evl_error_set(error, EVL_EXIT_CASE, place, "'%.*s' is no case of the design; its numbers are 0 to %ld",
                          length < SHOWN ? length : SHOWN, line, plan->design->n_cases - 1);
        }
    }
    free(line);
    (void)fclose(file);
    return good;
}

bool batch_todo(const batch_plan *plan, const char *cases_path, const journal_status *status, long **todo, long *n_todo,
                evl_error *error)
{
    const long n = batch_shard_size(plan);
    OWNED bool *is_wanted = xcalloc((size_t)plan->design->n_cases, sizeof *is_wanted);
    const bool good = cases_path == NULL || read_cases(plan, cases_path, is_wanted, error);
    *todo = xcalloc((size_t)n, sizeof **todo);
    *n_todo = 0;
    for (long i = 0; i < n && good; i++) {
        const long index = plan->first_case + i * plan->stride;
        if (cases_path != NULL ? is_wanted[index] : status[index] == JOURNAL_MISSING) {
            (*todo)[(*n_todo)++] = index;
        }
    }
    return good;
}
