/** Case of a command, with wheel compliances from the user's cache. */
#pragma once

#include "simulate/case_plan.h"

/** As case_plan_make. */
bool cached_case(case_plan *plan, const char *path, int n_set, const char *const *set, plan_roots roots,
                 evl_error *error);
