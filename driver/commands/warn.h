/** Warnings of a command on stderr about an accepted case. */
#pragma once

#include "simulate/prepare.h"

/** Print the warnings of a case and its model, one per line. */
void warn_of_case(const prepared_case *prepared);
/** Same, each preceded by the case's path or its location: for commands that accept several cases. */
void warn_of_file(const prepared_case *prepared);
