/** Many cases, those of a shard of a design, in one process or a few. docs/batch.md describes what it leaves. */
#pragma once

#include "base/status.h"

#include <stdbool.h>

typedef struct {
    const char *folder;
    const char *shard;      /**< "I/N"; NULL: 1/1 */
    const char *jobs;       /**< number of workers; NULL: 1 */
    const char *cases;      /**< file with the numbers of the only cases to run; NULL: all that are not recorded */
    const char *checkpoint; /**< minutes between two of a case; NULL: 10 */
    bool resume;            /**< go on with a journal that has rows already */
    bool check;             /**< only say which cases would be refused; `shard` alone goes with it */
    bool quiet;             /**< no progress */
} batch_options;

/** Run the shard of a design, or check it. Progress and a summary go to the log.
 *  @return EVL_EXIT_OK, or the code of `error`; EVL_EXIT_PARTIAL, with no error, if cases of the shard failed or were refused */
evl_exit batch(const char *design, const batch_options *options, evl_error *error);
