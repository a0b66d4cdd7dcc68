/** Time history of a run, or results of another analysis along an axis of its own: on file in the program
 *  (history*_hdf5.c), in memory in the library (history_memory.c), as linked.
 *
 *  A history grows as NAME.partial and is renamed to NAME only by history_close, which replaces an older one. As long
 *  as its rows fit into a few megabytes they stay in memory, and each flush writes a new file that replaces
 *  NAME.partial; longer ones grow in place. Every function that can fail returns false with the reason in `error`,
 *  EVL_EXIT_IO; after a failure only history_abandon may be called. */
#pragma once

#include "base/status.h"
#include "model/model.h"

typedef struct {
    const char *key;
    const char *text; /**< NULL: a number */
    long long integer;
    double number; /**< not 0: used instead of the integer */
} history_attribute;

/** Whether it is a number that need not be an integer. */
static inline bool history_is_number(const history_attribute *attribute)
{
    return attribute->text == NULL && attribute->number != 0;
}

/** An axis with numbers, or names. */
typedef struct {
    const char *name, *units, *symbol, *long_name;
    bool is_integer;
    int n;
    const double *values;     /**< [n] */
    const char *const *names; /**< [n]; NULL: numbers */
} history_coordinate;

typedef struct {
    const char *path;        /**< final name */
    const char *kind;        /**< of analysis, the attribute evolvent_kind */
    history_coordinate axis; /**< along which rows are appended, with their numbers */
    int n_coordinates;       /**< 0: outputs have the dimensions of a history, and there are events */
    const history_coordinate *coordinates;
    const model_names *names; /**< of a history; must outlive it, as event_kinds and `all` */
    int n_harmonics;          /**< of its metrics; 0: none */
    int n_outputs;
    const model_output *outputs; /**< must outlive the history */
    int n_all; /**< of a history of selected outputs: all outputs, whose dimensions it has; 0: those above */
    const model_output *all;
    int n_states;
    const model_state *states;
    int n_event_kinds;
    const char *const *event_kinds;
    long max_rows;         /**< largest number of history_append calls; 0 if unknown */
    double flush_interval; /**< [s]; 0: the default, after an earlier first flush */
    int n_attributes;
    const history_attribute *attributes; /**< of the root, known at the start */
    struct history **in_memory; /**< for a history in memory: receives it when it is closed; not used for a file */
} history_layout;

/** An event; mesh, flank and tooth_pair are -1 if not applicable. */
typedef struct {
    double t;
    int kind, mesh, flank, tooth_pair;
    const double *before, *after; /**< [n_states] the states before and after it */
} history_event;

typedef struct history history;

/** @return NULL with the reason in `error` */
history *history_create(const history_layout *layout, evl_error *error);
/** Write the static variables; before the first row. `values` at their offsets. */
void history_put_statics(history *history, const double *values);
/** Append rows at positions of the axis: value v of row k is values[v * stride + k]. Without history_put_statics static
 *  variables are taken from the first row. */
bool history_append_rows(history *history, int n, const double *positions, const double *values, int stride,
                         evl_error *error);
/** Append one row. */
bool history_append(history *history, double position, const double *values, evl_error *error);
bool history_add_event(history *history, const history_event *event, evl_error *error);
/** Write static variables that are known only at the end, after the last row and event; `values` at their offsets. */
bool history_put_finals(history *history, int n, const model_output *outputs, const double *values, evl_error *error);
/** Set further root attributes, flush, close, fsync; then rename if `commit`, else leave NAME.partial. Frees the
 *  history. */
bool history_close(history **history, bool commit, int n_attributes, const history_attribute *attributes,
                   evl_error *error);
/** Discard unwritten data, free the history, leave NAME.partial unchanged. */
void history_abandon(history **history);
/** NAME.partial */
const char *history_partial_path(const history *history);
/** Version of the library that writes it, such as "HDF5 1.10.8"; "" in memory. */
const char *history_version(void);
