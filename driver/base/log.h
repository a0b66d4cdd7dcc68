/** Messages of a command on stderr during its work, one line "evolvent: ..." each. Leaf module. */
#pragma once

#include <stdbool.h>

/** Quiet: suppress notes, not warnings and errors. */
void log_set_quiet(bool quiet);
__attribute__((format(printf, 1, 2))) void log_note(const char *format, ...);
__attribute__((format(printf, 1, 2))) void log_warning(const char *format, ...);
