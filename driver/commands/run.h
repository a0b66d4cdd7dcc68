/** One case from its file to its history. */
#ifndef EVOLVENT_RUN_H
#define EVOLVENT_RUN_H

#include "base/status.h"

#include <stdbool.h>

typedef struct {
    const char *case_path;
    const char *output; /**< NULL: the case's name with .h5 in the current folder */
    int n_set;
    const char *const *set; /**< [n_set] "PATH=VALUE" */
    bool show_progress;     /**< on stderr, if that is a terminal */
} run_options;

/** Run a case. Everything that can be refused is refused before the output file is touched. Warnings and a summary go to the
 *  log; why a run did not end well is for the caller to print.
 *  @return the exit code, which is error->code */
evl_exit run_case(const run_options *options, evl_error *error);

#endif
