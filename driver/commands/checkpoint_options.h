/** Options of a run with checkpoints. */
#pragma once

#include <stdbool.h>

/** Values on the command line; NULL if not given. */
typedef struct {
    const char *minutes;     /**< between two checkpoints */
    const char *at;          /**< model times, separated by commas */
    const char *max_minutes; /**< after which the run ends */
    bool continues;
} checkpoint_options;

/** Fault of the options; NULL if there is none. */
const char *checkpoint_options_check(const checkpoint_options *options);
bool checkpoint_options_any(const checkpoint_options *options);

/** @return whether a text is minutes above 0, which become seconds */
bool checkpoint_minutes(const char *text, double *seconds);
/** Read model times separated by commas, above 0 and ascending.
 *  @param at  space for one number more than there are commas; NULL: only check. @return their number; -1: invalid */
int checkpoint_times(const char *text, double *at);
