/** Conversion of YAML text to nodes, by libyaml. Private to case/. */
#pragma once

#include "case/case_tree.h"

/** The single document of a text, a copy with aliases expanded.
 *  @param path  name of the file in messages; NULL: the text is an option's, and `location` is the location of all nodes
 *  @return NULL if there is none or it was refused; error->code distinguishes these */
case_node *tree_load_yaml(memory_arena *arena, const char *path, case_location location, const char *text,
                          size_t length, evl_error *error);
