#include "batch/response_table.h"

static const statistics_scalar of_response[N_RESPONSE_SCALARS] = {
    [RESPONSE_JUMPS_UP] = {"jumps_up", "1", "number of jumps as the parameter increases"},
    [RESPONSE_JUMPS_DOWN] = {"jumps_down", "1", "number of jumps as the parameter decreases"},
    [RESPONSE_JUMP_UP_AT] = {"jump_up_at", "", "parameter after the first jump as it increases"},
    [RESPONSE_JUMP_DOWN_AT] = {"jump_down_at", "", "parameter after the first jump as it decreases"},
    [RESPONSE_LONGEST_PERIOD] = {"longest_period", "1",
                                 "largest number of common periods after which the motion repeats"},
    [RESPONSE_NOT_PERIODIC] = {"not_periodic", "1", "number of values at which the motion does not repeat"},
    [RESPONSE_STILL_SETTLING] = {"still_settling", "1", "number of values at which the motion is still settling"},
    [RESPONSE_CPU_TIME] = {"cpu_time", "s", "processor time since the start or the last resumption"},
};

const char *response_table_init(statistics_table *table, const model_names *names, int n_words,
                                const char *const *words)
{
    const char *unknown = statistics_table_of_metrics(table, names, n_words, words, N_RESPONSE_SCALARS);
    for (int i = 0; i < table->n; i++) {
        statistics_scalar *scalar = &table->scalars[i];
        scalar->name = arena_printf(&table->arena, "%s_largest", scalar->name);
        scalar->long_name = arena_printf(&table->arena, "%s, maximum over the parameter", scalar->long_name);
    }
    for (int i = 0; i < N_RESPONSE_SCALARS; i++) {
        table->scalars[table->n++] = of_response[i];
    }
    return unknown;
}
