/** The numbers that a batch keeps of each case, accumulated while it is simulated: one table says which. */
#pragma once

#include "base/archive.h"
#include "base/memory.h"
#include "integrate/integrate_types.h"
#include "model/model.h"
#include "simulate/simulate.h"

/** One number of a case. */
typedef struct {
    const char *name, *units, *long_name;
} statistics_scalar;

/** A number over whole periods: where it stands among them, and which scalar it becomes. */
typedef struct {
    int place, scalar;
} statistics_number;

/** What all cases of a batch have in common. */
typedef struct {
    memory_pool pool;
    model_names names; /**< of the base case; of its meshes, wheels and accelerometers only */
    int n_meshes, n;
    statistics_scalar *scalars; /**< [n] those of a mesh together, then those of the whole case, then further numbers */
    bool *taken;                /**< [N_NUMBER_ROWS] numbers over whole periods; a scalar of that name is this number */
    int n_numbers;              /**< 0: none */
    statistics_number *numbers; /**< [n_numbers] */
    int settled;                /**< scalar that says whether the window is settled; -1: none, without numbers */
    int multiplier;             /**< scalar of the orbit that the case starts on; -1: none */
} statistics_table;

/** The table for cases with these meshes, wheels and accelerometers. With several meshes each has its own numbers: NAME_MESH; those of
 *  the others are NAME_WHEEL, NAME_ACCELEROMETER.
 *  @param names          outlive the table
 *  @param words          which numbers over whole periods, as number_rows_take knows them
 *  @param some_periodic  whether a case may start on a periodic orbit. @return NULL, or a word that names none */
const char *statistics_table_init(statistics_table *table, const model_names *names, int n_words,
                                  const char *const *words, bool some_periodic);

/** A table of numbers over whole periods alone, with room for `more` scalars behind them. @return as above */
const char *statistics_table_of_numbers(statistics_table *table, const model_names *names, int n_words,
                                        const char *const *words, int more);

typedef struct statistics statistics;

/** Begin a case with meshes and wheels as in the table; it wants what the numbers are made of.
 *  @param window  of time of all numbers of a mesh [s], both ends included */
statistics *statistics_create(const statistics_table *table, wanted_outputs *wanted, const number_window *window,
                              double output_interval);
void statistics_delete(statistics **statistics);
/** The extremes in the window, which the simulation finds between the outputs. */
extremes *statistics_extremes(const statistics *statistics);
/** The numbers over whole periods; NULL if there are none. */
numbers *statistics_numbers(const statistics *statistics);

/** The blocks come in order of time. */
void statistics_outputs(statistics *statistics, const output_block *block);
void statistics_event(statistics *statistics, const event_record *record);
/** Keep what was accumulated, but for what the simulation keeps: extremes and numbers. */
void statistics_keep(statistics *statistics, archive *archive);
/** Whether any output lay in the window. */
bool statistics_has_outputs(const statistics *statistics);
/** The numbers of the table; NaN where there was nothing to accumulate.
 *  @param multiplier  the largest in size of the orbit on which the case starts; NaN without one
 *  @param result   of the simulation; if it did not come to its end, the numbers of the meshes, whose window is not full, are NaN
 *  @param results      [table.n] */
void statistics_finish(const statistics *statistics, const simulate_result *result, double multiplier, double *results);
