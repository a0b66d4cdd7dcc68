/** File of a history, with its attributes and constants. Private to history*_hdf5.c and part_hdf5.c. */
#pragma once

#include "files/dimensions_in_file_hdf5.h"
#include "files/history_body.h"
#include "files/output_file.h"
#include "files/series_hdf5.h"

struct history {
    history_body body;
    output_file file;
    netcdf_file netcdf;
    hid_t events_group;
    bool grows;       /**< some rows are on file and no longer in memory */
    bool is_put;      /**< all rows are in the open file: it is the last one */
    double due;       /**< of the next flush, by its clock [s] */
    double next_look; /**< wall clock of the next reading of that clock [s] */
};

/** Create the file with all data of known size, except attributes of the root: names, the group of events, constants. */
bool history_write_head(history *history, const char *path);
/** Write variables that are constant over time. */
bool history_write_statics(history *history, int n, const model_output *outputs, const double *values);
/** Set attributes of the root; older values are replaced. */
bool history_put_attributes(history *history, int n, const history_attribute *attributes);
/** Required after all variables, and before a flush: write the lists of users of the dimensions. */
bool history_finish(history *history);

/** Make space for a row in a series, if necessary on file. */
bool history_reserve(history *history, series *rows);
/** Make the present data readable from time to time. */
bool history_flush_if_due(history *history);
/** Report why writing failed; the first reason is kept. @return false */
bool history_refuse(const history *history, evl_error *error);
