/** What `evolvent modes` prints. */
#ifndef EVOLVENT_MODES_PRINT_H
#define EVOLVENT_MODES_PRINT_H

#include "case.h"
#include "model_modes.h"

#include <stdio.h>

typedef struct {
    const case_file *file;
    const model *model;
    const dae_state *state; /**< at which the gearbox is linearised */
    const double *values;   /**< [model_n_values] the outputs there */
    bool is_steady;         /**< the steady state under load, not the motion at a time */
    natural_modes modes;
} modes_report;

/* Each returns EVL_EXIT_OK, or EVL_EXIT_IO if the stream could not be written. */

/** Tables for reading. */
int modes_print_text(FILE *stream, const modes_report *report);
/** One JSON object in SI units and in full precision, for scripts. */
int modes_print_json(FILE *stream, const modes_report *report);

#endif
