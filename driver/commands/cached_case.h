/** Case of a command, with wheel compliances from the user's cache. */
#pragma once

#include "simulate/prepare.h"

/** As prepare_case. @param with_root_stress  add the root stress of wheels with finite elements */
bool cached_case(prepared_case *prepared, const char *path, int n_set, const char *const *set, bool with_root_stress,
                 evl_error *error);
