/** Batch of the cases in a shard of a design, in one or several processes. docs/guides/batch.md describes its output files. */
#pragma once

#include "base/status.h"

#include <stdbool.h>

typedef struct {
    const char *folder;
    const char *shard;      /**< "I/N"; NULL: 1/1 */
    const char *jobs;       /**< number of workers; NULL: 1 */
    const char *cases;      /**< file with the numbers of the cases to run; NULL: all that are not recorded */
    const char *checkpoint; /**< minutes between two checkpoints of a case; NULL: 10 */
    bool resume;            /**< continue a journal that already has rows */
    bool check;             /**< only list the cases that would be refused; allowed with `shard` only */
    bool quiet;             /**< no progress */
} batch_options;

/** Run the shard of a design, or check it. Progress and a summary go to the log.
 *  @return EVL_EXIT_OK, or the code of `error`; EVL_EXIT_PARTIAL, with no error, if cases of the shard failed or were refused */
evl_exit batch(const char *design, const batch_options *options, evl_error *error);
