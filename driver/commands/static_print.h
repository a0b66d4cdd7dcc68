/** What `evolvent static` prints. */
#pragma once

#include "case/case.h"
#include "model/model_static.h"

#include <stdio.h>

typedef struct {
    const case_file *file;
    const static_plan *plan;
    const char *path; /**< of the file with all that was found */
    bool gives_way;   /**< whether a wheel has a compliance */
    bool is_bare;     /**< tooth pairs carry without a contact pressure, on sharp tip edges */
    int n_torques;
    const double *torques; /**< [n_torques] */
    const double *numbers; /**< [n_torques][plan->n_outputs] the first value of each output */
} static_report;

void static_print_text(FILE *stream, const static_report *report);
/** Numbers of the torques, in SI units. */
void static_print_json(FILE *stream, const static_report *report);
