/** Output of `evolvent show` for scripts, one JSON object each. */
#pragma once

#include "simulate/case_plan.h"

#include <stdio.h>

/** "radau" or "ida" */
const char *integrator_name(const simulation_description *simulation);
/** The complete case, in SI units and radians, in full precision. @param refusal  why the case cannot run, if so */
void show_json(FILE *stream, const case_plan *plan, const evl_error *refusal);
/** The numbers of the case, by their paths. */
void show_parameters_json(FILE *stream, const model *model);
