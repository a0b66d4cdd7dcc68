/** The numbers that a batch keeps of each case, accumulated while it is simulated: one table says which. */
#pragma once

#include "base/memory.h"
#include "integrate/integrate_types.h"
#include "model/model.h"
#include "simulate/simulate.h"

/** One number of a case. */
typedef struct {
    const char *name, *units, *long_name;
} statistics_scalar;

/** What all cases of a batch have in common. */
typedef struct {
    memory_pool pool;
    int n_meshes, n;
    statistics_scalar *scalars; /**< [n] those of a mesh together, then those of the whole case */
} statistics_table;

/** The table for cases with these meshes. With several, each has its own numbers: NAME_MESH. */
void statistics_table_init(statistics_table *table, int n_meshes, const char *const *mesh_names);

typedef struct statistics statistics;

/** Begin a case with n_meshes as in the table.
 *  @param from, to  window of time of all numbers of a mesh [s], both ends included */
statistics *statistics_create(const statistics_table *table, const model *model, double from, double to,
                              double output_interval);
void statistics_delete(statistics **statistics);
/** The extremes in the window, which the simulation finds between the outputs. */
extremes *statistics_extremes(const statistics *statistics);

/** @param values  of model_outputs */
void statistics_outputs(statistics *statistics, double t, const double *values);
void statistics_event(statistics *statistics, const event_record *record);
/** The numbers of the table; NaN where there was nothing to accumulate.
 *  @param result   of the simulation; if it did not come to its end, the numbers of the meshes, whose window is not full, are NaN
 *  @param results      [table.n] */
void statistics_finish(const statistics *statistics, const simulate_result *result, double *results);
