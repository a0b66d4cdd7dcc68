/** What the journals of a folder record of each case, for whoever collects or counts it. docs/batch.md describes the lines. */
#pragma once

#include "base/status.h"

#include <stdio.h>

typedef enum {
    RECORDS_WHOLE,
    RECORDS_BRIEF, /**< without the numbers of the cases */
    RECORDS_COUNTS /**< only how many cases became what */
} records_detail;

/** Print how many cases became what and the journals' first lines, then the record of each case that counts, in the order
 *  of the cases.
 *  @return the code of `error`: EVL_EXIT_CASE with the journal's path if one cannot be understood or read */
evl_exit records(FILE *stream, const char *folder, records_detail detail, evl_error *error);
