/** Mesh of an option `--mesh`. */
#pragma once

#include "base/status.h"
#include "case/description.h"

/** Index of a mesh by its name or index. @param text  NULL: the first mesh
 *  @return false with the reason in `error`, EVL_EXIT_USAGE */
bool find_mesh(const description *description, const char *text, int *mesh, evl_error *error);
