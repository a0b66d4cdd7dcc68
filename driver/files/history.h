/** The time history of a run, or what another analysis finds along an axis of its own: on file in the program (history*_hdf5.c), in
 *  memory in the library (history_memory.c). Who links chooses.
 *
 *  A history grows as NAME.partial and gets NAME only by history_close, which replaces an older one. As long as its rows fit into a
 *  few megabytes they are kept, and each flush writes a new file that takes the place of NAME.partial; longer ones grow in place.
 *  Every function that can fail returns false with the reason in `error`, EVL_EXIT_IO; after a failure only history_abandon may
 *  follow. */
#pragma once

#include "base/status.h"
#include "model/model.h"

typedef struct {
    const char *key;
    const char *text; /**< NULL: it is a number */
    long long integer;
    double number; /**< not 0: this one instead of the integer */
} history_attribute;

/** Whether it is a number that need not be whole. */
static inline bool history_is_number(const history_attribute *attribute)
{
    return attribute->text == NULL && attribute->number != 0;
}

/** An axis with numbers. */
typedef struct {
    const char *name, *units, *symbol, *long_name;
    bool is_integer;
    int n;
    const double *values; /**< [n] */
} history_coordinate;

typedef struct {
    const char *path;        /**< final name */
    const char *kind;        /**< of analysis, the attribute evolvent_kind */
    history_coordinate axis; /**< along which rows are appended; its numbers come with them */
    int n_coordinates;       /**< 0: outputs have the dimensions of a history, and there are events */
    const history_coordinate *coordinates;
    const model_names *names; /**< of a history; outlive it, as event_kinds and `all` do */
    int n_harmonics;          /**< the same, of its numbers; 0: none */
    int n_outputs;
    const model_output *outputs; /**< outlive the history */
    int n_all; /**< of a history of some outputs all that there are, whose dimensions it has; 0: those above */
    const model_output *all;
    int n_states;
    const model_state *states;
    int n_event_kinds;
    const char *const *event_kinds;
    long max_rows;         /**< the most that history_append will be called; 0 if that is not known */
    double flush_interval; /**< [s]; 0: the usual one, after a first flush that comes sooner */
    int n_attributes;
    const history_attribute *attributes; /**< of the root, known at the start */
    struct history **kept; /**< of a history in memory: where it is when it is closed; a file has no need of it */
} history_layout;

/** Something that happened; mesh, flank and tooth_pair are -1 where it concerns none. */
typedef struct {
    double t;
    int kind, mesh, flank, tooth_pair;
    const double *before, *after; /**< [n_states] the states on both sides */
} history_event;

typedef struct history history;

/** @return NULL with the reason in `error` */
history *history_create(const history_layout *layout, evl_error *error);
/** The static variables; to come before the first row. `values` as their offsets say. */
void history_put_statics(history *history, const double *values);
/** Rows at places of the axis: value v of row k is values[v * stride + k]. Without history_put_statics static variables are taken
 *  from the first row. */
bool history_append_rows(history *history, int n, const double *places, const double *values, int stride,
                         evl_error *error);
/** One row. */
bool history_append(history *history, double place, const double *values, evl_error *error);
bool history_add_event(history *history, const history_event *event, evl_error *error);
/** Static variables that are known at the end only, behind the last row and event; `values` as their offsets say. */
bool history_put_finals(history *history, int n, const model_output *outputs, const double *values, evl_error *error);
/** Set further root attributes, flush, close, fsync; then rename if `commit`, else leave NAME.partial. Frees the history. */
bool history_close(history **history, bool commit, int n_attributes, const history_attribute *attributes,
                   evl_error *error);
/** Drop what cannot be written any more, free, leave NAME.partial as it is. */
void history_abandon(history **history);
/** NAME.partial */
const char *history_partial_path(const history *history);
/** Version of the library that writes it, such as "HDF5 1.10.8"; "" in memory. */
const char *history_version(void);
