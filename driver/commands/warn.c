#include "commands/warn.h"

#include "base/log.h"
#include "base/memory.h"

void warn_of_case(const case_plan *plan, const model_start_orbit *start)
{
    ARENA_SCOPE memory_arena arena = {NULL};
    int n = 0;
    const char **warnings = case_plan_warning_list(plan, start, &arena, &n);
    for (int i = 0; i < n; i++) {
        log_warning("%s", warnings[i]);
    }
}

void warn_of_file(const case_plan *plan)
{
    ARENA_SCOPE memory_arena arena = {NULL};
    const char *path = plan->path;
    int n = 0, n_located = 0;
    const char **warnings = case_plan_warning_list(plan, NULL, &arena, &n);
    (void)case_warnings(plan->file, &arena, &n_located);
    for (int i = 0; i < n; i++) {
        log_warning("%s%s%s", i < n_located ? "" : path, i < n_located ? "" : ": ", warnings[i]);
    }
}
