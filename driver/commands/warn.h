/** What a command says on stderr of a case that it does not refuse. */
#pragma once

#include "simulate/prepare.h"

/** The model's warnings, a line each. */
void warn_of_case(const prepared_case *prepared);
