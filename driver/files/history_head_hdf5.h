/** The file of a history, with its attributes and constants. Private to history*_hdf5.c and part_hdf5.c. */
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
    bool grows;       /**< rows are on file that are no more in memory */
    bool is_put;      /**< all rows are in the file that is open: it is the last one */
    double due;       /**< of the next flush, by its clock [s] */
    double next_look; /**< at that clock, by the usual one [s] */
};

/** Create the file with everything whose size is known, but no attributes of the root: names, the group of events, constants. */
bool history_write_head(history *history, const char *path);
/** Variables that do not change. */
bool history_write_statics(history *history, int n, const model_output *outputs, const double *values);
/** Set attributes of the root; older values are replaced. */
bool history_put_attributes(history *history, int n, const history_attribute *attributes);
/** To come after all variables, and before a flush: dimensions list who has them. */
bool history_finish(history *history);

/** See that a series has room for a row, if need be on file. */
bool history_make_room(history *history, series *rows);
/** Let what is there be read, from time to time. */
bool history_flush_if_due(history *history);
/** Say why writing failed; the first reason counts. @return false */
bool history_refuse(const history *history, evl_error *error);
