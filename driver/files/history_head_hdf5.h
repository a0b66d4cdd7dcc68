/** What a history is beside its rows: the file, its attributes and dimensions, which columns its series have, constants. Private to
 *  history*_hdf5.c. */
#pragma once

#include "files/dimensions_hdf5.h"
#include "files/history.h"
#include "files/output_file.h"
#include "files/series_hdf5.h"

/** Where an event's numbers are in its row; then come both sides of each state. */
enum { EVENT_TIME, EVENT_KIND, EVENT_MESH, EVENT_FLANK, EVENT_TOOTH_PAIR, EVENT_STATES };

struct history {
    memory_pool pool;
    output_file file;
    netcdf_file netcdf;
    history_layout layout; /**< as it was given; attributes and coordinates are its own */
    dimensions dimensions;
    netcdf_dimension side;
    hid_t events_group;
    series times, events;
    bool has_events, has_statics;
    bool grows;  /**< rows are on file that are no more in memory */
    bool is_put; /**< all rows are in the file that is open: it is the last one */
    int n_values;
    double *statics;   /**< [n_values] */
    double *event_row; /**< [EVENT_STATES + 2 n_states] */
    long long n_events;
    double due;       /**< of the next flush, by its clock [s] */
    double next_look; /**< at that clock, by the usual one [s] */
};

/** Keep the layout, and plan the series. */
void history_plan(history *history, const history_layout *layout);
/** Create the file with everything whose size is known, but no attributes of the root: names, the group of events, constants. */
bool history_write_head(history *history, const char *path);
/** Variables that do not change. */
bool history_write_statics(history *history, int n, const model_output *outputs, const double *values);
/** Set attributes of the root; older values are replaced. */
bool history_put_attributes(history *history, int n, const history_attribute *attributes);
/** To come after all variables, and before a flush: dimensions list who has them. */
bool history_finish(history *history);
