/** The file that a command writes of a case. */
#pragma once

#include "base/status.h"

/** The given name, or the case's with SUFFIX.h5 in the current folder, as a new string. */
char *result_path(const char *given, const char *case_path, const char *suffix);
/** Whether it is another file than the case. @param what  it is, for the message. @return false with the reason in `error` */
bool result_spares_case(const char *what, const char *path, const char *case_path, evl_error *error);
/** Versions of all that made it, as a new string. */
char *result_versions(void);
