/** Case of a command, with wheel compliances from the user's cache. */
#pragma once

#include "commands/command.h"
#include "simulate/case_plan.h"

/** As case_plan_make. */
bool cached_case(case_plan *plan, const char *path, const option_values *set, plan_roots roots, evl_error *error);

/** The options --set, and --outputs as the last of them. @param outputs  NULL: not given
 *  @param arena  owns the result */
option_values set_with_outputs(const option_values *set, const char *outputs, memory_arena *arena);
