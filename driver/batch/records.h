/** Records of each case in the journals of a folder, for collecting or counting. docs/guides/batch.md describes the lines. */
#pragma once

#include "base/status.h"

#include <stdio.h>

typedef enum {
    RECORDS_WHOLE,
    RECORDS_BRIEF, /**< without the metrics of the cases */
    RECORDS_COUNTS /**< only the number of cases of each status */
} records_detail;

/** Print the number of cases of each status, the journals' first lines, and the valid record of each case in the order
 *  of the cases.
 *  @return the code of `error`: EVL_EXIT_CASE with the journal's path if one is invalid or cannot be read */
evl_exit records(FILE *stream, const char *folder, records_detail detail, evl_error *error);
