/** Output of `evolvent static`. */
#pragma once

#include "case/case.h"
#include "model/model_static.h"

#include <stdio.h>

typedef struct {
    const case_file *file;
    const static_plan *plan;
    const char *path;  /**< of the file with all results */
    bool is_compliant; /**< whether a wheel is compliant */
    int n_torques;
    const double *torques; /**< [n_torques] */
    const double *numbers; /**< [n_torques][plan->n_outputs] the first value of each output */
} static_report;

void static_print_text(FILE *stream, const static_report *report);
/** Metrics for the torques, in SI units. */
void static_print_json(FILE *stream, const static_report *report);
