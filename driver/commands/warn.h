/** Warnings of a command on stderr about an accepted case. */
#pragma once

#include "simulate/case_plan.h"

/** Print the warnings of a case and its model, one per line. @param start  as in case_plan_warning_list */
void warn_of_case(const case_plan *plan, const model_start_orbit *start);
/** Same, each preceded by the case's path or its location: for commands that accept several cases. */
void warn_of_file(const case_plan *plan);
