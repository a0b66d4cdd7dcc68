/** Motions of a gearbox over one parameter that increases and decreases in steps: the motion at a value starts from the
 *  final state at the previous value. docs/guides/response.md. */
#pragma once

#include "respond/respond_options.h"

/** Read the limit of common periods at a value. @return false, with `respond_periods` as message */
bool respond_read_most(const char *text, int *most);
extern const char respond_periods[];

/** Read the number of values for orbits. @return false, with `respond_values` as message */
bool respond_read_values(const char *text, int *n);
extern const char respond_values[];
/** Read the largest length of orbits in common periods. @return false, with `respond_longest` as message */
bool respond_read_longest(const char *text, int *n);
extern const char respond_longest[];

/** Check the request without computing. @return the exit code, with the reason in `error` */
evl_exit respond_check(const char *case_path, const respond_options *options, evl_error *error);
/** @param case_path  file of the case, or the name of its text in error messages
 *  @return the exit code, with the reason in `error` */
evl_exit respond(const char *case_path, const respond_options *options, evl_error *error);
