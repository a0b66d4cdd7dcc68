#include "files/history.h"

#include "base/memory.h"
#include "base/progress.h"
#include "files/history_head_hdf5.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

/** Time until the first flush, and between flushes. */
static const double first_flush = 2, flush_interval = 5; /* s */

bool history_refuse(const history *history, evl_error *error)
{
    return output_file_refuse(history->file.partial_path, history->netcdf.system_error, history->netcdf.reason, error);
}

/** Store the reason why a file is not available: a system error, 0 if there is none. */
static bool is_had(history *history, int system_error)
{
    netcdf_file *netcdf = &history->netcdf;
    if (system_error != 0 && netcdf->reason[0] == '\0') {
        netcdf->system_error = system_error;
        (void)snprintf(netcdf->reason, sizeof netcdf->reason, "%s", strerror(system_error));
    }
    return system_error == 0;
}

/** Clock for flushes, in seconds. A flush of rows in memory writes all of them, and limits the CPU time lost if the run
 *  is killed: there CPU time is used, independent of the load of the machine. */
static double flush_clock(const history *history)
{
    const bool is_dear = !history->grows && history->body.layout.flush_interval <= 0;
    return is_dear ? (double)clock() / CLOCKS_PER_SEC : clock_seconds();
}

static void plan_flush(history *history, double usual)
{
    const double given = history->body.layout.flush_interval, interval = given > 0 ? given : usual;
    history->due = flush_clock(history) + interval;
    history->next_look = clock_seconds() + interval;
}

static void free_history(history *history)
{
    history_body_free(&history->body);
    arena_free(&history->netcdf.arena);
    free(history);
}

history *history_create(const history_layout *layout, evl_error *error)
{
    output_file file;
    if (!output_file_open(&file, layout->path, error)) {
        return NULL;
    }
    history *history = xcalloc(1, sizeof *history);
    history->file = file;
    history_plan(&history->body, layout, history->netcdf.reason);
    plan_flush(history, first_flush);
    return history;
}

/* ---- the file ---- */

/** Create a new file, next to the existing one, with everything except rows and attributes of the root. */
static bool begin_file(history *history)
{
    return is_had(history, output_file_begin_fresh(&history->file)) &&
           history_write_head(history, history->file.fresh_path);
}

static bool put_rows(history *history)
{
    return series_put_whole(&history->body.times, &history->netcdf, history->netcdf.id) &&
           (!history->body.has_events ||
            series_put_whole(&history->body.events, &history->netcdf, history->events_group));
}

static bool put_first_attributes(history *history)
{
    return history_put_attributes(history, history->body.layout.n_attributes, history->body.layout.attributes);
}

/** Write all present rows to a file of their own. */
static bool put_snapshot(history *history)
{
    netcdf_file *netcdf = &history->netcdf;
    return begin_file(history) && put_first_attributes(history) && put_rows(history) && history_finish(history) &&
           netcdf_flush(netcdf) && netcdf_close(netcdf) && is_had(history, output_file_show(&history->file));
}

static bool write_series(history *history)
{
    netcdf_file *netcdf = &history->netcdf;
    return series_write(&history->body.times, netcdf) &&
           (!history->body.has_events || series_write(&history->body.events, netcdf));
}

/** Start a growing file, since the rows exceed the memory limit. */
static bool start_growing(history *history)
{
    history->grows = true;
    plan_flush(history, flush_interval);
    return begin_file(history) && put_first_attributes(history) &&
           series_begin(&history->body.times, &history->netcdf, history->netcdf.id) &&
           (!history->body.has_events ||
            series_begin(&history->body.events, &history->netcdf, history->events_group)) &&
           write_series(history) && history_finish(history) && netcdf_flush(&history->netcdf) &&
           is_had(history, output_file_show(&history->file));
}

/** Metadata of the rows on file are written only here. */
static bool flush_file(history *history)
{
    return write_series(history) && is_had(history, output_file_hide(&history->file)) &&
           netcdf_flush(&history->netcdf) && is_had(history, output_file_show(&history->file));
}

/* Makes most of a killed run readable. The CPU clock is expensive and never ahead of the wall clock. */
bool history_flush_if_due(history *history)
{
    const double now = clock_seconds();
    if (now < history->next_look) {
        return true;
    }
    const double left = history->due - flush_clock(history);
    if (left > 0) {
        history->next_look = now + left;
        return true;
    }
    const bool good = history->grows ? flush_file(history) : put_snapshot(history);
    plan_flush(history, flush_interval);
    return good;
}

/* ---- rows ---- */

bool history_reserve(history *history, series *rows)
{
    return rows->filled < rows->capacity ||
           (history->grows ? series_write(rows, &history->netcdf) : series_enlarge(rows) || start_growing(history));
}

static bool append(history *history, series *rows, int n, const double *positions, const double *values, int stride,
                   evl_error *error)
{
    bool good = true;
    for (int done = 0; done < n && good;) {
        good = history_reserve(history, rows);
        const int taken = good ? series_append(rows, n - done, positions + done, values + done, stride) : -1;
        good = taken >= 0;
        done += taken;
    }
    return (good && history_flush_if_due(history)) || history_refuse(history, error);
}

void history_put_statics(history *history, const double *values)
{
    history_set_statics(&history->body, values);
}

bool history_append_rows(history *history, int n, const double *positions, const double *values, int stride,
                         evl_error *error)
{
    history_take_statics(&history->body, values, stride);
    return append(history, &history->body.times, n, positions, values, stride, error);
}

bool history_append(history *history, double position, const double *values, evl_error *error)
{
    return history_append_rows(history, 1, &position, values, 1, error);
}

bool history_add_event(history *history, const history_event *event, evl_error *error)
{
    const double number = history_event_row(&history->body, event);
    return append(history, &history->body.events, 1, &number, history->body.event_row, 1, error);
}

/* ---- the end ---- */

/** Write all remaining rows. */
static bool put_last_rows(history *history)
{
    const bool is_put = history->is_put;
    history->is_put = true;
    return is_put || (history->grows ? write_series(history) : begin_file(history) && put_rows(history));
}

bool history_put_finals(history *history, int n, const model_output *outputs, const double *values, evl_error *error)
{
    return (put_last_rows(history) && history_write_statics(history, n, outputs, values)) ||
           history_refuse(history, error);
}

/** Write the attributes of the start that are not changed at the end. */
static bool put_unchanged_attributes(history *history, int n, const history_attribute *attributes)
{
    const history_layout *layout = &history->body.layout;
    bool good = true;
    for (int i = 0; i < layout->n_attributes && good; i++) {
        const history_attribute *attribute = &layout->attributes[i];
        good = !history_is_unchanged(attribute, n, attributes) || history_put_attributes(history, 1, attribute);
    }
    return good;
}

static bool write_end(history *history, int n, const history_attribute *attributes)
{
    netcdf_file *netcdf = &history->netcdf;
    return put_last_rows(history) && (history->grows || put_unchanged_attributes(history, n, attributes)) &&
           history_put_attributes(history, n, attributes) && history_finish(history) &&
           (!history->grows || is_had(history, output_file_hide(&history->file))) && netcdf_flush(netcdf) &&
           netcdf_close(netcdf) && is_had(history, output_file_show(&history->file));
}

bool history_close(history **pointer, bool commit, int n_attributes, const history_attribute *attributes,
                   evl_error *error)
{
    history *history = *pointer;
    *pointer = NULL;
    bool good = write_end(history, n_attributes, attributes);
    if (good) {
        good = output_file_close(&history->file, commit, error);
    } else {
        (void)history_refuse(history, error);
        output_file_drop(&history->file, false);
    }
    free_history(history);
    return good;
}

void history_abandon(history **pointer)
{
    if (*pointer != NULL) {
        output_file_drop(&(*pointer)->file, false);
        free_history(*pointer);
        *pointer = NULL;
    }
}

const char *history_partial_path(const history *history)
{
    return history->file.partial_path;
}

const char *history_version(void)
{
    static char text[32];
    unsigned version[3] = {0};
    netcdf_library_version(version);
    (void)snprintf(text, sizeof text, "HDF5 %u.%u.%u", version[0], version[1], version[2]);
    return text;
}
