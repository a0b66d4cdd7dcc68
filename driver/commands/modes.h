/** `evolvent modes`: the gearbox linearised at a steady state, their mean, or at a time of its motion. */
#ifndef EVOLVENT_MODES_H
#define EVOLVENT_MODES_H

#include "base/status.h"

#include <stdbool.h>

typedef struct {
    const char *case_path;
    /* Which state: at most one of these three; none: the steady state where the case starts. */
    const char *at;            /**< time [s] as a text, or NULL */
    const char *mesh_position; /**< steady state at so many pitches from the start of contact, as a text, or NULL */
    bool mean;                 /**< the mean over the steady states at all positions of the meshes */
    int n_set;
    const char *const *set; /**< [n_set] "PATH=VALUE" */
    bool json;              /**< one JSON object, else text for reading */
} modes_options;

/** Print the natural modes of a case to the stream. Why that did not work is for the caller to print.
 *  @return the exit code; error->code is the same but for EVL_EXIT_IO, when the stream could not be written */
evl_exit modes_case(const modes_options *options, FILE *stream, evl_error *error);

#endif
