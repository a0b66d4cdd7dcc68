#include "batch/batch_statistics.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct {
    int index;   /**< index of the output among the values; -1 if the model has none */
    double sum;  /**< integral over time [unit s] */
    double last; /**< of the previous output */
} accumulator;

struct statistics {
    const statistics_table *table;
    double from, to;
    double t;       /**< of the last output */
    double t_first; /**< of the window */
    double t_last;
    bool is_in_window;    /**< the last output was in the window */
    accumulator *of_mesh; /**< [n_meshes * STATISTICS_OF_MESH] */
    extremes *extremes;   /**< in the window */
    metrics *metrics;     /**< metrics over whole periods; NULL: none */
    long *events;         /**< [kinds] */
};

/** Whether a row is a sum over the outputs: other rows are extremes, which are also searched between outputs. */
static bool sums_up(int row)
{
    return statistics_of_mesh[row].reduction != STATISTICS_RANGE &&
           statistics_of_mesh[row].reduction != STATISTICS_LARGEST;
}

static const char *resolve_output(const model *model, const char *name)
{
    const bool counts_pairs = strcmp(name, "pairs_in_contact") == 0;
    /* A model with one pair per mesh only provides whether that is in contact. */
    return counts_pairs && model_output_offset(model, name) < 0 ? "in_contact" : name;
}

statistics *statistics_create(const statistics_table *table, requested_outputs *requested, const metric_window *window,
                              double output_interval)
{
    static const double slack = 1e-6; /* relative to the output interval: smaller differences of times are rounding */
    const model *model = requested->model;
    statistics *statistics = xcalloc(1, sizeof *statistics);
    *statistics =
        (struct statistics){.table = table,
                            .from = window->from - slack * output_interval,
                            .to = window->to + slack * output_interval,
                            .t_first = NAN,
                            .of_mesh = xcalloc((size_t)table->n_meshes * STATISTICS_OF_MESH, sizeof(accumulator)),
                            .extremes = extremes_create(model, table->n_meshes, window->from, window->to),
                            .metrics = table->n_metrics == 0 ? NULL : metrics_create(model, window, table->taken),
                            .events = xcalloc((size_t)model_tables()->n_event_kinds, sizeof(long))};
    for (int mesh = 0; mesh < table->n_meshes; mesh++) {
        for (int i = 0; i < STATISTICS_OF_MESH; i++) {
            const int index =
                sums_up(i) ? requested_outputs_add(requested, resolve_output(model, statistics_of_mesh[i].output)) : -1;
            statistics->of_mesh[mesh * STATISTICS_OF_MESH + i] = (accumulator){.index = index < 0 ? -1 : index + mesh};
        }
    }
    return statistics;
}

void statistics_delete(statistics **pointer)
{
    statistics *statistics = *pointer;
    *pointer = NULL;
    if (statistics != NULL) {
        free(statistics->of_mesh);
        free(statistics->events);
        extremes_delete(&statistics->extremes);
        metrics_delete(&statistics->metrics);
        free(statistics);
    }
}

extremes *statistics_extremes(const statistics *statistics)
{
    return statistics->extremes;
}

metrics *statistics_metrics(const statistics *statistics)
{
    return statistics->metrics;
}

bool statistics_has_outputs(const statistics *statistics)
{
    return !isnan(statistics->t_first);
}

/** Value of an output for a row, at several times. */
static void reduce_values(int row, int n, const double *values, double *reduced)
{
    const double pairs = statistics_of_mesh[row].pairs;
    switch (statistics_of_mesh[row].reduction) {
    case STATISTICS_SHARE_OF:
        for (int k = 0; k < n; k++) {
            reduced[k] = fabs(values[k] - pairs) < 0.5 ? 1.0 : 0.0;
        }
        return;
    case STATISTICS_SHARE_FROM:
        for (int k = 0; k < n; k++) {
            reduced[k] = values[k] > pairs - 0.5 ? 1.0 : 0.0;
        }
        return;
    default:
        memcpy(reduced, values, (size_t)n * sizeof *values);
    }
}

/** Contributions of a row to its integral at each time. @param dt  [n] since the previous time, 0 if that is outside
 *  the window */
static void find_parts(accumulator *a, int row, int first, int n, const double *dt, const output_block *block,
                       double parts[DAE_LANES])
{
    double values[DAE_LANES], last = a->last;
    reduce_values(row, n, output_values(block, a->index) + first, values);
    for (int k = 0; k < n; k++) {
        parts[k] = 0.5 * dt[k] * (last + values[k]);
        last = values[k];
    }
    a->last = last;
}

/** @param dt  as above */
static void add_to_mesh(accumulator of_mesh[STATISTICS_OF_MESH], int first, int n, const double *dt,
                        const output_block *block)
{
    double parts[STATISTICS_OF_MESH][DAE_LANES], sums[STATISTICS_OF_MESH];
    int rows[STATISTICS_OF_MESH], n_rows = 0;
    for (int i = 0; i < STATISTICS_OF_MESH; i++) {
        accumulator *a = &of_mesh[i];
        if (sums_up(i) && a->index < 0) {
            a->sum = a->last = NAN;
        } else if (sums_up(i)) {
            find_parts(a, i, first, n, dt, block, parts[n_rows]);
            sums[n_rows] = a->sum;
            rows[n_rows++] = i;
        }
    }
    for (int k = 0; k < n; k++) { /* in the order of time, but with independent sums, so that they can be computed in
                                   * parallel */
        for (int i = 0; i < n_rows; i++) {
            sums[i] += parts[i][k];
        }
    }
    for (int i = 0; i < n_rows; i++) {
        of_mesh[rows[i]].sum = sums[i];
    }
}

void statistics_outputs(statistics *statistics, const output_block *block)
{
    double dt[DAE_LANES];
    int first = block->n, end = 0;
    for (int k = 0; k < block->n; k++) {
        const double t = block->t[k];
        const bool is_in_window = t >= statistics->from && t <= statistics->to;
        dt[k] = is_in_window && statistics->is_in_window ? t - statistics->t : 0.0;
        if (is_in_window) {
            statistics->t_first = statistics->is_in_window ? statistics->t_first : t;
            statistics->t_last = t;
            first = k < first ? k : first;
            end = k + 1;
        }
        statistics->is_in_window = is_in_window;
        statistics->t = t;
    }
    if (first < end) {
        for (int mesh = 0; mesh < statistics->table->n_meshes; mesh++) {
            add_to_mesh(statistics->of_mesh + mesh * STATISTICS_OF_MESH, first, end - first, dt + first, block);
        }
    }
}

void statistics_event(statistics *statistics, const event_record *record)
{
    if (record->what.kind >= 0 && record->what.kind < model_tables()->n_event_kinds) {
        statistics->events[record->what.kind]++;
    }
}

void statistics_serialize(statistics *statistics, archive *archive)
{
    SERIALIZE(archive, statistics->t);
    SERIALIZE(archive, statistics->t_first);
    SERIALIZE(archive, statistics->t_last);
    SERIALIZE(archive, statistics->is_in_window);
    SERIALIZE_ARRAY(archive, statistics->of_mesh, statistics->table->n_meshes * STATISTICS_OF_MESH);
    SERIALIZE_ARRAY(archive, statistics->events, model_tables()->n_event_kinds);
}

/** An extreme in the window. */
static double extreme_of(const statistics *statistics, int row, int mesh, bool is_largest)
{
    return extremes_found(statistics->extremes, extremes_find(statistics_of_mesh[row].output, is_largest), mesh).value;
}

static double reduce(const statistics *statistics, int row, int mesh, double span)
{
    const accumulator *a = &statistics->of_mesh[mesh * STATISTICS_OF_MESH + row];
    switch (statistics_of_mesh[row].reduction) {
    case STATISTICS_LARGEST:
        return extreme_of(statistics, row, mesh, true);
    case STATISTICS_RANGE:
        return extreme_of(statistics, row, mesh, true) - extreme_of(statistics, row, mesh, false);
    default:
        return isnan(span) ? NAN : span > 0 ? a->sum / span : a->last;
    }
}

/** Set the metrics over whole periods, replacing those of the same name. */
static void put_metrics(const statistics *statistics, double *results)
{
    const statistics_table *table = statistics->table;
    model_output rows[N_METRIC_ROWS];
    const int n = metric_rows_lay_out(&table->names, rows);
    CLEANUP_FREE double *values = xcalloc((size_t)n, sizeof *values);
    metrics_conclude(statistics->metrics, values);
    for (int i = 0; i < table->n_metrics; i++) {
        results[table->metrics[i].scalar] = values[table->metrics[i].index];
    }
    results[table->settled] = metrics_settled(statistics->metrics)->is_settled;
}

void statistics_finish(const statistics *statistics, const simulate_result *result, double multiplier, double *results)
{
    const double span = statistics->t_last - statistics->t_first;
    int n = 0;
    for (int i = 0; i < statistics->table->n_meshes * STATISTICS_OF_MESH; i++) {
        results[n++] = result->end == SIMULATE_DONE
                           ? reduce(statistics, i % STATISTICS_OF_MESH, i / STATISTICS_OF_MESH, span)
                           : NAN;
    }
    results[n + STATISTICS_ENERGY_RESIDUAL] = result->energy_residual;
    results[n + STATISTICS_STEPS] = (double)result->counts.steps;
    results[n + STATISTICS_CPU_TIME] = result->counts.cpu_seconds;
    n += STATISTICS_OF_CASE;
    for (int kind = 0; kind < model_tables()->n_event_kinds; kind++) {
        results[n++] = (double)statistics->events[kind];
    }
    while (n < statistics->table->n) {
        results[n++] = NAN;
    }
    if (statistics->table->multiplier >= 0) {
        results[statistics->table->multiplier] = multiplier;
    }
    if (statistics->metrics != NULL && result->end == SIMULATE_DONE) {
        put_metrics(statistics, results);
    }
}
