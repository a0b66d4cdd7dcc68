#include "commands/cached_case.h"

#include "files/wheel_cache.h"

bool cached_case(case_plan *plan, const char *path, int n_set, const char *const *set, plan_roots roots,
                 evl_error *error)
{
    wheel_cache *cache = wheel_cache_open();
    const plan_request request = {
        .name = path, .n_set = n_set, .set = set, .wheels = wheel_cache_store(cache), .roots = roots};
    const bool good = case_plan_make(plan, &request, error);
    wheel_cache_close(&cache);
    return good;
}
