/** Line of a case in the journal. */
#pragma once

#include "batch/batch_plan.h"
#include "batch/journal.h"

typedef struct {
    journal_status status;
    char *line; /**< of the journal, with its newline; to be freed */
    size_t length;
    bool has_checkpoints; /**< obsolete when the row is recorded */
} batch_row;

/** @param results  [n scalars], NULL: none
 *  @param history  row of the stack, NULL: none */
void batch_row_write(const batch_plan *plan, long index, journal_status status, const char *message,
                     const double *results, const float *history, batch_row *row);
