#include "commands/warn.h"

#include "base/log.h"
#include "base/memory.h"

void warn_of_case(const prepared_case *prepared)
{
    ARENA_SCOPE memory_arena arena = {NULL};
    int n = 0;
    const char **warnings = prepare_warning_list(prepared, &arena, &n);
    for (int i = 0; i < n; i++) {
        log_warning("%s", warnings[i]);
    }
}

void warn_of_file(const prepared_case *prepared)
{
    ARENA_SCOPE memory_arena arena = {NULL};
    const char *path = case_path(prepared->file);
    int n = 0, n_located = 0;
    const char **warnings = prepare_warning_list(prepared, &arena, &n);
    (void)case_warnings(prepared->file, &arena, &n_located);
    for (int i = 0; i < n; i++) {
        log_warning("%s%s%s", i < n_located ? "" : path, i < n_located ? "" : ": ", warnings[i]);
    }
}
