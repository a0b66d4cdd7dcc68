/** Case of a command, with wheel compliances from the user's cache. */
#pragma once

#include "simulate/prepare.h"

/** As prepare_case. */
bool cached_case(prepared_case *prepared, const char *path, int n_set, const char *const *set, evl_error *error);
