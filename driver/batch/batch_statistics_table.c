#include "batch/batch_statistics_table.h"

#include "base/words.h"
#include "simulate/metric_channel.h"
#include "simulate/metric_rows.h"

#include <ctype.h>
#include <string.h>

const statistics_row statistics_of_mesh[STATISTICS_OF_MESH] = {
    {"transmission_error_mean", "m", "mean transmission error", "transmission_error", STATISTICS_MEAN, 0},
    {"transmission_error_peak_to_peak", "m", "peak-to-peak transmission error", "transmission_error", STATISTICS_RANGE,
     0},
    {"normal_force_mean", "N", "mean normal force", "normal_force", STATISTICS_MEAN, 0},
    {"normal_force_max", "N", "largest normal force", "normal_force", STATISTICS_LARGEST, 0},
    {"penetration_max", "m", "largest penetration", "penetration", STATISTICS_LARGEST, 0},
    {"share_no_contact", "1", "share of the time without contact", "pairs_in_contact", STATISTICS_SHARE_OF, 0},
    {"share_one_pair", "1", "share of the time with one pair in contact", "pairs_in_contact", STATISTICS_SHARE_OF, 1},
    {"share_two_pairs", "1", "share of the time with two pairs in contact", "pairs_in_contact", STATISTICS_SHARE_OF, 2},
    {"share_more_pairs", "1", "share of the time with three or more pairs in contact", "pairs_in_contact",
     STATISTICS_SHARE_FROM, 3},
};

static const struct {
    const char *name, *units, *long_name;
} of_case[STATISTICS_OF_CASE] = {
    [STATISTICS_ENERGY_RESIDUAL] = {"energy_residual", "1",
                                    "largest error of the energy balance over the energy input"},
    [STATISTICS_STEPS] = {"steps", "1", "steps of the integrator"},
    [STATISTICS_CPU_TIME] = {"cpu_time", "s", "processor time of the integration"},
};

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
static void add_numbers(statistics_table *table)
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
    add_numbers(table);
    return unknown;
}

const char *statistics_table_init(statistics_table *table, const model_names *names, int n_words,
                                  const char *const *words, bool some_periodic)
{
    const int n_kinds = model_tables()->n_event_kinds, n_meshes = names->meshes.n;
    const char *unknown =
        begin_table(table, names, n_words, words, n_meshes * STATISTICS_OF_MESH + STATISTICS_OF_CASE + n_kinds + 2);
    for (int i = 0; i < n_meshes * STATISTICS_OF_MESH; i++) {
        const int mesh = i / STATISTICS_OF_MESH;
        const statistics_row *row = &statistics_of_mesh[i % STATISTICS_OF_MESH];
        const char *of = n_meshes == 1 ? NULL : names->meshes.names[mesh];
        add(table, of == NULL ? row->name : own_name_of(table, row->name, mesh, of), row->units,
            of == NULL ? row->long_name : arena_printf(&table->arena, "%s, mesh '%s'", row->long_name, of));
    }
    for (int i = 0; i < STATISTICS_OF_CASE; i++) {
        add(table, of_case[i].name, of_case[i].units, of_case[i].long_name);
    }
    for (int kind = 0; kind < n_kinds; kind++) {
        const char *name = model_tables()->event_kinds[kind];
        add(table, arena_printf(&table->arena, "events_%s", name), "1",
            arena_printf(&table->arena, "number of events %s", name));
    }
    add_numbers(table);
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
