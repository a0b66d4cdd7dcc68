/** What a history is before its first row: the file, its attributes and dimensions, and which columns its series have. Private to
 *  history*_hdf5.c. */
#pragma once

#include "files/dimensions_hdf5.h"
#include "files/history.h"
#include "files/output_file.h"
#include "files/series_hdf5.h"

/** Columns of the series of events; then come both sides of each state. */
enum { EVENT_NUMBER, EVENT_TIME, EVENT_KIND, EVENT_MESH, EVENT_FLANK, EVENT_TOOTH_PAIR, EVENT_STATES };

struct history {
    output_file file;
    netcdf_file netcdf;
    dimensions dimensions;
    netcdf_dimension side;
    series times, events;
    bool has_events;
    int n_outputs, n_values, n_states;
    const model_output *outputs;
    double *row;       /**< [1 + n_values] time and outputs */
    double *event_row; /**< [EVENT_STATES + 2 n_states] */
    long long n_rows, n_events;
    double last_flush; /**< clock [s] */
};

/** The variable of an output, with its dimensions. */
netcdf_variable history_describe_output(history *history, const model_output *output);
/** Set attributes of the root. */
bool history_put_attributes(history *history, int n, const history_attribute *attributes);
/** Everything whose size is known: attributes, names, the group of events. */
bool history_write_head(history *history, const history_layout *layout);
