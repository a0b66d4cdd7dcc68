/** Result file of a command. */
#pragma once

#include "analyses/versions.h"
#include "base/status.h"

/** The given name, or the case's with a suffix such as -static.h5 in the current folder.
 *  @param what       kind of result, for the message
 *  @param case_path  "-": standard input
 *  @return a new string; NULL with the reason in `error` if there is no name, or if it is that of the case itself */
char *result_path(const char *what, const char *given, const char *case_path, const char *suffix, evl_error *error);
