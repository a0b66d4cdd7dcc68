/** What a command says on stderr of a case that it does not refuse. */
#pragma once

#include "simulate/prepare.h"

/** Print the warnings of a case and its model, a line each. */
void warn_of_case(const prepared_case *prepared);
/** The same, each with the case's path or its location in front: for commands that take several cases. */
void warn_of_file(const prepared_case *prepared);
