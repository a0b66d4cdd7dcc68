/** Keys renamed within format 1. The former names are accepted for one release, in case files and in paths. */
#pragma once

#include "case/case_tree.h"

/** Rename the former keys of a tree that is not checked yet. A former key beside the present one stays, to be refused. */
void tree_use_present_keys(case_node *root);
/** Replace former keys in the text of a checked case, as from case_text: a new string, instead of the given one. */
void case_text_use_present_keys(char **text);
/** The path with present keys: a new string. */
char *path_with_present_keys(const char *path);
/** The path with former keys: a new string; NULL if all its keys have always had their name. */
char *path_with_former_keys(const char *path);
/** The present key of a block for a former one; NULL if it is no former key. */
const char *key_of_former(const char *block, const char *former);
/** The former name of a key of a block; NULL if it has none. */
const char *former_of_key(const char *block, const char *key);
