/** What a history in memory holds when it is closed (history.h). */
#pragma once

#include "files/history_body.h"

/** A variable with its values, and where it would be on file. */
typedef struct {
    netcdf_variable variable;
    bool is_of_events;  /**< in the group of events */
    const void *values; /**< doubles, ints, or texts, the last dimension fastest */
} history_variable;

struct history {
    history_body body;
    char reason[NETCDF_REASON_LENGTH];
    int n_variables, room;
    history_variable *variables; /**< [n_variables] in the order of a file */
    int n_attributes;
    history_attribute *attributes; /**< [n_attributes] of the root, in the order of a file */
};

void history_free(history **history);

/* What is kept, in the order of the calls. */
/** A variable with texts of its own: those it has may go with the case, or with who puts it. Its dimensions and values stay where
 *  they are, in the history's pool or as long as that. */
void history_keep_variable(history *history, const netcdf_variable *variable, bool is_of_events, const void *values);
/** The coordinate of a dimension, names with a copy of their own. */
void history_keep_coordinate(history *history, netcdf_dimension *dimension, const dimension_values *values,
                             bool is_of_events);
void history_keep_attribute(history *history, const history_attribute *attribute);
/** Numbers as a variable of this type has them; doubles stay where they are. */
const void *history_numbers(history *history, netcdf_type type, int n, const double *numbers);
