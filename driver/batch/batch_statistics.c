#include "batch/batch_statistics.h"

#include "base/words.h"
#include "simulate/metric_channel.h"

#include <ctype.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/** Reductions of outputs to one number. Means and shares weight each output with its part of the time (trapezoidal
 *  rule). */
typedef enum {
    MEAN,
    RANGE, /**< largest minus smallest */
    LARGEST,
    SHARE_OF,  /**< of the time with exactly `pairs` */
    SHARE_FROM /**< of the time with `pairs` or more */
} reduction;

/** Metrics of each mesh. */
static const struct {
    const char *name, *units, *long_name, *output;
    reduction reduction;
    int pairs;
} of_mesh[] = {
    {"transmission_error_mean", "m", "mean transmission error", "transmission_error", MEAN, 0},
    {"transmission_error_peak_to_peak", "m", "peak-to-peak transmission error", "transmission_error", RANGE, 0},
    {"normal_force_mean", "N", "mean normal force", "normal_force", MEAN, 0},
    {"normal_force_max", "N", "largest normal force", "normal_force", LARGEST, 0},
    {"penetration_max", "m", "largest penetration", "penetration", LARGEST, 0},
    {"share_no_contact", "1", "share of the time without contact", "pairs_in_contact", SHARE_OF, 0},
    {"share_one_pair", "1", "share of the time with one pair in contact", "pairs_in_contact", SHARE_OF, 1},
    {"share_two_pairs", "1", "share of the time with two pairs in contact", "pairs_in_contact", SHARE_OF, 2},
    {"share_more_pairs", "1", "share of the time with three or more pairs in contact", "pairs_in_contact", SHARE_FROM,
     3},
};
enum { N_OF_MESH = sizeof of_mesh / sizeof *of_mesh };

/** Metrics of the whole case, followed by the number of events of each kind. */
enum { ENERGY_RESIDUAL, STEPS, CPU_TIME, N_OF_CASE };
static const struct {
    const char *name, *units, *long_name;
} of_case[N_OF_CASE] = {
    [ENERGY_RESIDUAL] = {"energy_residual", "1", "largest error of the energy balance over the energy input"},
    [STEPS] = {"steps", "1", "steps of the integrator"},
    [CPU_TIME] = {"cpu_time", "s", "processor time of the integration"},
};

/* ---- the table ---- */

/** Index of a scalar; -1: there is none. */
static int find_scalar(const statistics_table *table, const char *name)
{
    for (int i = 0; i < table->n; i++) {
        if (strcmp(table->scalars[i].name, name) == 0) {
            return i;
        }
    }
    return -1;
}

/** NAME_MESH; letters not allowed in identifiers become underscores. */
static char *name_of(statistics_table *table, const char *name, const char *element)
{
    char *full = arena_printf(&table->arena, "%s_%s", name, element);
    for (char *c = full; *c != '\0'; c++) {
        *c = (char)(isalnum((unsigned char)*c) ? *c : '_');
    }
    return full;
}

/** Same, with a number appended if that name is used. */
static const char *own_name_of(statistics_table *table, const char *name, int index, const char *element)
{
    char *full = name_of(table, name, element);
    return find_scalar(table, full) >= 0 ? arena_printf(&table->arena, "%s_%d", full, index) : full;
}

static void add(statistics_table *table, const char *name, const char *units, const char *long_name)
{
    table->scalars[table->n++] = (statistics_scalar){.name = name, .units = units, .long_name = long_name};
}

/** Element k of a row as a scalar: NAME_HARMONIC_AXIS_ELEMENT, without dimensions of length 1. */
static int add_number(statistics_table *table, const model_output *row, int k)
{
    memory_arena *arena = &table->arena;
    const name_list *of = metric_elements(row->dims, &table->names);
    const int each = row->count / of->n;
    const char *name = row->name, *text = row->long_name;
    if (words_contain(row->dims, "harmonic")) {
        const int order = k % METRIC_HARMONICS + 1;
        name = arena_printf(arena, "%s_%d", name, order);
        text = arena_printf(arena, "%s, order %d", text, order);
    }
    if (words_contain(row->dims, "axis")) {
        name = arena_printf(arena, "%s_%c", name, "xy"[k * 2 / each % 2]);
    }
    if (of != &table->names.meshes || of->n > 1) {
        name = name_of(table, name, of->names[k / each]);
        text = arena_printf(arena, "%s, %s", text, of->names[k / each]);
    }
    const int known = find_scalar(table, name);
    if (known < 0) {
        add(table, name, row->units, text);
    }
    return known < 0 ? table->n - 1 : known;
}

/** Add the metrics over whole periods: one scalar each, or an existing one of the same name. */
static void add_metrics(statistics_table *table)
{
    model_output rows[N_METRIC_ROWS];
    (void)metric_rows_lay_out(&table->names, rows);
    for (int i = 0; i < N_METRIC_ROWS; i++) {
        for (int k = 0; k < rows[i].count && table->taken[i]; k++) {
            table->metrics[table->n_metrics++] =
                (statistics_metric){rows[i].offset + k, add_number(table, &rows[i], k)};
        }
    }
}

/** An empty table with space for the requested metrics, and `more`. @return as statistics_table_init */
static const char *begin_table(statistics_table *table, const model_names *names, int n_words, const char *const *words,
                               int more)
{
    *table = (statistics_table){.names = *names, .n_meshes = names->meshes.n, .settled = -1, .multiplier = -1};
    model_output rows[N_METRIC_ROWS];
    const int most = metric_rows_lay_out(names, rows);
    table->taken = arena_calloc(&table->arena, N_METRIC_ROWS, sizeof *table->taken);
    table->metrics = arena_calloc(&table->arena, (size_t)most, sizeof *table->metrics);
    table->scalars = arena_calloc(&table->arena, (size_t)most + (size_t)more, sizeof *table->scalars);
    return metric_rows_select(n_words, words, table->taken);
}

const char *statistics_table_of_metrics(statistics_table *table, const model_names *names, int n_words,
                                        const char *const *words, int more)
{
    const char *unknown = begin_table(table, names, n_words, words, more);
    add_metrics(table);
    return unknown;
}

const char *statistics_table_init(statistics_table *table, const model_names *names, int n_words,
                                  const char *const *words, bool some_periodic)
{
    const int n_kinds = model_tables()->n_event_kinds, n_meshes = names->meshes.n;
    const char *unknown = begin_table(table, names, n_words, words, n_meshes * N_OF_MESH + N_OF_CASE + n_kinds + 2);
    for (int i = 0; i < n_meshes * N_OF_MESH; i++) {
        const int mesh = i / N_OF_MESH, row = i % N_OF_MESH;
        const char *of = n_meshes == 1 ? NULL : names->meshes.names[mesh], *text = of_mesh[row].long_name;
        add(table, of == NULL ? of_mesh[row].name : own_name_of(table, of_mesh[row].name, mesh, of), of_mesh[row].units,
            of == NULL ? text : arena_printf(&table->arena, "%s, mesh '%s'", text, of));
    }
    for (int i = 0; i < N_OF_CASE; i++) {
        add(table, of_case[i].name, of_case[i].units, of_case[i].long_name);
    }
    for (int kind = 0; kind < n_kinds; kind++) {
        const char *name = model_tables()->event_kinds[kind];
        add(table, arena_printf(&table->arena, "events_%s", name), "1",
            arena_printf(&table->arena, "number of events %s", name));
    }
    add_metrics(table);
    table->settled = table->n_metrics > 0 ? table->n : -1;
    if (table->settled >= 0) {
        add(table, "window_settled", "1", "1 if the motion had settled before the window, 0 if not; NaN: unknown");
    }
    if (some_periodic) {
        table->multiplier = table->n;
        add(table, "start_multiplier", "1",
            "largest magnitude of the Floquet multipliers of the orbit at the start; NaN: none");
    }
    return unknown;
}

/* ---- one case ---- */

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
    accumulator *of_mesh; /**< [n_meshes * N_OF_MESH] */
    extremes *extremes;   /**< in the window */
    metrics *metrics;     /**< metrics over whole periods; NULL: none */
    long *events;         /**< [kinds] */
};

/** Whether a row is a sum over the outputs: other rows are extremes, which are also searched between outputs. */
static bool sums_up(int row)
{
    return of_mesh[row].reduction != RANGE && of_mesh[row].reduction != LARGEST;
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
                            .of_mesh = xcalloc((size_t)table->n_meshes * N_OF_MESH, sizeof(accumulator)),
                            .extremes = extremes_create(model, table->n_meshes, window->from, window->to),
                            .metrics = table->n_metrics == 0 ? NULL : metrics_create(model, window, table->taken),
                            .events = xcalloc((size_t)model_tables()->n_event_kinds, sizeof(long))};
    for (int mesh = 0; mesh < table->n_meshes; mesh++) {
        for (int i = 0; i < N_OF_MESH; i++) {
            const int index =
                sums_up(i) ? requested_outputs_add(requested, resolve_output(model, of_mesh[i].output)) : -1;
            statistics->of_mesh[mesh * N_OF_MESH + i] = (accumulator){.index = index < 0 ? -1 : index + mesh};
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
    const double pairs = of_mesh[row].pairs;
    switch (of_mesh[row].reduction) {
    case SHARE_OF:
        for (int k = 0; k < n; k++) {
            reduced[k] = fabs(values[k] - pairs) < 0.5 ? 1.0 : 0.0;
        }
        return;
    case SHARE_FROM:
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
static void add_to_mesh(accumulator of_mesh[N_OF_MESH], int first, int n, const double *dt, const output_block *block)
{
    double parts[N_OF_MESH][DAE_LANES], sums[N_OF_MESH];
    int rows[N_OF_MESH], n_rows = 0;
    for (int i = 0; i < N_OF_MESH; i++) {
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
            add_to_mesh(statistics->of_mesh + mesh * N_OF_MESH, first, end - first, dt + first, block);
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
    SERIALIZE_ARRAY(archive, statistics->of_mesh, statistics->table->n_meshes * N_OF_MESH);
    SERIALIZE_ARRAY(archive, statistics->events, model_tables()->n_event_kinds);
}

/** An extreme in the window. */
static double extreme_of(const statistics *statistics, int row, int mesh, bool is_largest)
{
    return extremes_found(statistics->extremes, extremes_find(of_mesh[row].output, is_largest), mesh).value;
}

static double reduce(const statistics *statistics, int row, int mesh, double span)
{
    const accumulator *a = &statistics->of_mesh[mesh * N_OF_MESH + row];
    switch (of_mesh[row].reduction) {
    case LARGEST:
        return extreme_of(statistics, row, mesh, true);
    case RANGE:
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
    for (int i = 0; i < statistics->table->n_meshes * N_OF_MESH; i++) {
        results[n++] = result->end == SIMULATE_DONE ? reduce(statistics, i % N_OF_MESH, i / N_OF_MESH, span) : NAN;
    }
    results[n + ENERGY_RESIDUAL] = result->energy_residual;
    results[n + STEPS] = (double)result->counts.steps;
    results[n + CPU_TIME] = result->counts.cpu_seconds;
    n += N_OF_CASE;
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
