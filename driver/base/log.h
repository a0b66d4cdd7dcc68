/** What a command says on stderr while it works, each a line "evolvent: ...". A leaf. */
#pragma once

#include <stdbool.h>

/** Quiet: notes are left out; warnings and errors stay. */
void log_set_quiet(bool quiet);
__attribute__((format(printf, 1, 2))) void log_note(const char *format, ...);
__attribute__((format(printf, 1, 2))) void log_warning(const char *format, ...);
