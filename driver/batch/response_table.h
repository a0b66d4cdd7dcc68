/** Results of a case of a batch that is a response. */
#pragma once

#include "batch/batch_statistics.h"

/** Results of a response, after the metrics. */
enum {
    RESPONSE_JUMPS_UP,
    RESPONSE_JUMPS_DOWN,
    RESPONSE_JUMP_UP_AT,
    RESPONSE_JUMP_DOWN_AT,
    RESPONSE_LONGEST_PERIOD,
    RESPONSE_NOT_PERIODIC,
    RESPONSE_STILL_SETTLING,
    RESPONSE_CPU_TIME,
    N_RESPONSE_SCALARS
};

/** Metrics of a response: the largest values of the metrics over whole periods named by words, jumps, periods. As in
 *  statistics_table_init. */
const char *response_table_init(statistics_table *table, const model_names *names, int n_words,
                                const char *const *words);
