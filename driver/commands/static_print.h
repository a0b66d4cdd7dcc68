/** Output of `evolvent static`, after static_analyse. */
#pragma once

#include "analyses/static_analysis.h"

#include <stdio.h>

void static_print_text(FILE *stream, const static_analysis *analysis);
/** Metrics for the torques, in SI units. */
void static_print_json(FILE *stream, const static_analysis *analysis);
