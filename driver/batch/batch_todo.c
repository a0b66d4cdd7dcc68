#include "batch/batch_todo.h"

#include "base/memory.h"

#include <errno.h>
#include <limits.h>
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

/** The cases listed in a file. */
typedef struct {
    bool *is_requested; /**< [n_cases] */
    long after;         /**< cases recorded after this number of rows of the journal are not run again */
} case_list;

/** Read the number in a line. @return false if it is invalid */
static bool take_line(const batch_plan *plan, const char *line, bool is_first, case_list *list)
{
    static const char after[] = "after ";
    char *end = NULL;
    const char *start = skip_blanks(line);
    if (*start == '\0') {
        return true;
    }
    const bool is_after = is_first && strncmp(start, after, sizeof after - 1) == 0;
    start += is_after ? sizeof after - 1 : 0;
    errno = 0;
    const long index = strtol(start, &end, 10);
    const bool is_number = end != start && *skip_blanks(end) == '\0' && errno == 0 && index >= 0;
    if (is_number && is_after) {
        list->after = index;
    } else if (!is_number || index >= plan->design->n_cases) {
        return false;
    } else if (index % plan->stride == plan->first_case) { /* else it belongs to another shard */
        list->is_requested[index] = true; /* NOLINT(clang-analyzer-security.ArrayBound): it is less than n_cases */
    }
    return true;
}

static bool read_cases(const batch_plan *plan, const char *path, case_list *list, evl_error *error)
{
    enum { SHOWN = 40 }; /* characters of a bad line */
    FILE *file = fopen(path, "rb");
    char *line = NULL;
    size_t capacity = 0;
    long n_lines = 0;
    bool good = true;
    if (file == NULL) {
        return evl_error_set(error, EVL_EXIT_CASE, path, "cannot be read: %s", strerror(errno));
    }
    while (good && getline(&line, &capacity, file) > 0) {
        n_lines++;
        good = take_line(plan, line, n_lines == 1, list);
        if (!good) {
            CLEANUP_FREE char *location = xasprintf("%s:%ld", path, n_lines);
            const int length = (int)strcspn(line, "\r\n");
            evl_error_set(error, EVL_EXIT_CASE, location,
                          "'%.*s' is not a case of the design; cases are numbered 0 to %ld",
                          length < SHOWN ? length : SHOWN, line, plan->design->n_cases - 1);
        }
    }
    if (good && feof(file) == 0) {
        good = evl_error_set(error, EVL_EXIT_CASE, path, "cannot be read: %s", strerror(errno));
    }
    free(line);
    (void)fclose(file);
    return good;
}

bool batch_todo(const batch_plan *plan, const char *cases_path, const journal_case *cases, long **todo, long *n_todo,
                evl_error *error)
{
    const long n = batch_shard_size(plan);
    CLEANUP_FREE bool *is_requested = xcalloc((size_t)plan->design->n_cases, sizeof *is_requested);
    case_list list = {.is_requested = is_requested, .after = LONG_MAX};
    const bool good = cases_path == NULL || read_cases(plan, cases_path, &list, error);
    *todo = xcalloc((size_t)n, sizeof **todo);
    *n_todo = 0;
    for (long i = 0; i < n && good; i++) {
        const long index = plan->first_case + i * plan->stride;
        const bool is_left = list.is_requested[index] && cases[index].row <= list.after;
        if (cases_path != NULL ? is_left : cases[index].status == JOURNAL_MISSING) {
            (*todo)[(*n_todo)++] = index;
        }
    }
    return good;
}
