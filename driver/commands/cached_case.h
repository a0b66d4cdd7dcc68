/** A case of a command, with wheels whose compliance the user's cache knows. */
#pragma once

#include "simulate/prepare.h"

/** As prepare_case. */
bool cached_case(prepared_case *prepared, const char *path, int n_set, const char *const *set, evl_error *error);
