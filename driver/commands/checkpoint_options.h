/** The words of a run that can go on after it was stopped. */
#pragma once

#include <stdbool.h>

/** What the command line says of it; NULL where it says nothing. */
typedef struct {
    const char *minutes;     /**< between two checkpoints */
    const char *at;          /**< model times, with commas */
    const char *max_minutes; /**< after which the run ends */
    bool continues;
} checkpoint_options;

/** What is wrong with the options; NULL if nothing is. */
const char *checkpoint_options_check(const checkpoint_options *options);
bool checkpoint_options_any(const checkpoint_options *options);

/** @return whether a text is minutes above 0, which become seconds */
bool checkpoint_minutes(const char *text, double *seconds);
/** Model times with commas, above 0 and rising.
 *  @param at  room for as many numbers as there are commas, and one more; NULL: they are only read. @return how many; -1: no times */
int checkpoint_times(const char *text, double *at);
