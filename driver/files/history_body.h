/** Common part of histories on file and in memory: dimensions, columns, constants. Private to history*.c. */
#pragma once

#include "files/dimensions.h"
#include "files/history.h"
#include "files/series.h"

/** Offsets of an event's numbers in its row, followed by each state before and after it. */
enum { EVENT_TIME, EVENT_KIND, EVENT_MESH, EVENT_FLANK, EVENT_TOOTH_PAIR, EVENT_STATES };

typedef struct {
    memory_arena arena;
    history_layout layout; /**< a copy with its own attributes and coordinates */
    dimensions dimensions;
    netcdf_dimension side;
    dimension_values sides;
    series times, events;
    bool has_events, has_statics;
    int n_values;
    double *statics;   /**< [n_values] */
    double *event_row; /**< [EVENT_STATES + 2 n_states] */
    long long n_events;
} history_body;

/** Copy the layout, and plan the series. @param reason  as in a series */
void history_plan(history_body *body, const history_layout *layout, char *reason);
/** Set the constants before all rows. */
void history_set_statics(history_body *body, const double *values);
/** Take the constants from the first row, unless they are set. */
void history_take_statics(history_body *body, const double *values, int stride);
/** Write the row of an event. @return its index */
double history_event_row(history_body *body, const history_event *event);
void history_body_free(history_body *body);

/** Number of attributes of every history, before its own. */
enum { N_COMMON_ATTRIBUTES = 3 };
void history_common_attributes(const history_layout *layout, history_attribute attributes[N_COMMON_ATTRIBUTES]);
/** Whether an attribute of the start is not changed at the end. */
bool history_is_unchanged(const history_attribute *attribute, int n, const history_attribute *at_end);
