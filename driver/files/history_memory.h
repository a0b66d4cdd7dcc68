/** Content of a closed history in memory (history.h). */
#pragma once

#include "files/history_body.h"

/** A variable with its values, and its location on file. */
typedef struct {
    netcdf_variable variable;
    bool is_of_events;  /**< in the group of events */
    const void *values; /**< doubles, ints, or texts, the last dimension fastest */
} history_variable;

struct history {
    history_body body;
    char reason[NETCDF_REASON_LENGTH];
    int n_variables, capacity;
    history_variable *variables; /**< [n_variables] in the order of a file */
    int n_attributes;
    history_attribute *attributes; /**< [n_attributes] of the root, in the order of a file */
};

void history_free(history **history);

/* The following functions store data, in the order of the calls. */
/** Store a variable with copies of its texts, which may belong to the case or the caller. Its dimensions and values are
 *  not copied: they are in the history's arena or live as long. */
void history_store_variable(history *history, const netcdf_variable *variable, bool is_of_events, const void *values);
/** Store the coordinate of a dimension, with copies of names. */
void history_store_coordinate(history *history, netcdf_dimension *dimension, const dimension_values *values,
                              bool is_of_events);
void history_store_attribute(history *history, const history_attribute *attribute);
/** Numbers in the type of a variable; doubles are not copied. */
const void *history_numbers(history *history, netcdf_type type, int n, const double *numbers);
