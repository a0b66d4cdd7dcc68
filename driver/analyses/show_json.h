/** What `evolvent show` tells scripts of a case, each one JSON object. */
#pragma once

#include "simulate/prepare.h"

#include <stdio.h>

/** "radau" or "ida" */
const char *integrator_name(const simulation_description *simulation);
/** All of it, in SI units and radians, in full precision. @param refusal  why the case cannot run, if so */
void show_json(FILE *stream, const prepared_case *prepared, const evl_error *refusal);
/** The numbers that the case gives, by their paths. */
void show_parameters_json(FILE *stream, const model *model);
