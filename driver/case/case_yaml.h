/** YAML text to nodes, by libyaml. Private to case/. */
#pragma once

#include "case/case_tree.h"

/** The one document of a text, a copy without aliases.
 *  @param path   what messages call the file; NULL: it is the text of an option, and `place` that of all nodes
 *  @return NULL if there is none or it was refused: then error->code tells */
case_node *tree_load_yaml(memory_pool *pool, const char *path, case_place place, const char *text, size_t length,
                          evl_error *error);
