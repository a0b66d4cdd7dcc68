/** What the journals of a folder record of each case, for whoever collects or counts it. docs/batch.md describes the lines. */
#pragma once

#include "base/status.h"

#include <stdbool.h>
#include <stdio.h>

/** Print the journals' first lines, then the record of each case that counts, in the order of the cases.
 *  @param brief  without the numbers of the cases
 *  @return the code of `error`: EVL_EXIT_CASE with the journal's path if one cannot be understood or read */
evl_exit records(FILE *stream, const char *folder, bool brief, evl_error *error);
