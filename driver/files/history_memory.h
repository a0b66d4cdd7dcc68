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
