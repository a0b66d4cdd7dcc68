#include "commands/cached_case.h"

#include "files/wheel_cache.h"

bool cached_case(prepared_case *prepared, const char *path, int n_set, const char *const *set, bool with_root_stress,
                 evl_error *error)
{
    wheel_cache *cache = wheel_cache_open();
    const bool good = prepare_case_with(prepared, path, n_set, set, wheel_cache_store(cache), error) &&
                      (!with_root_stress || prepare_root_stress(prepared, wheel_cache_store(cache), error));
    wheel_cache_close(&cache);
    return good;
}
