#include "commands/cached_case.h"

#include "files/wheel_cache.h"

bool cached_case(case_plan *plan, const char *path, const option_values *set, plan_roots roots, evl_error *error)
{
    wheel_cache *cache = wheel_cache_open();
    const plan_request request = {
        .name = path, .n_set = set->n, .set = set->values, .wheels = wheel_cache_store(cache), .roots = roots};
    const bool good = case_plan_make(plan, &request, error);
    wheel_cache_close(&cache);
    return good;
}

option_values set_with_outputs(const option_values *set, const char *outputs, memory_arena *arena)
{
    if (outputs == NULL) {
        return *set;
    }
    const char **values = arena_calloc(arena, (size_t)set->n + 1, sizeof *values);
    for (int i = 0; i < set->n; i++) {
        values[i] = set->values[i];
    }
    values[set->n] = arena_printf(arena, "simulation.outputs=%s", outputs);
    return (option_values){.n = set->n + 1, .values = values};
}
