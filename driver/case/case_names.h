/** Names of blocks, and references to them by name. */
#ifndef EVOLVENT_CASE_NAMES_H
#define EVOLVENT_CASE_NAMES_H

#include "case/case_check.h"

/** The names of a list of blocks (its `name` keys) or of a map (its keys); the caller frees the array. */
const char **case_names(const case_node *node);
/** Index of a name among n; -1 if it is not there. */
int case_name_index(const char *name, int n, const char *const *names);

/** Index of what `node`, the value of `key` or an element of it, names in `among`; refused if there is no such thing. */
bool case_find_name(checker *checker, const case_node *node, const char *key, const char *what, const case_node *among,
                    int *index);
/** The same of the value of a block's key. */
bool case_find_reference(checker *checker, const case_node *block, const char *key, const char *what,
                         const case_node *among, int *index);
/** Refuse a list of blocks in which a name stands twice. */
bool case_check_unique(checker *checker, const case_node *list, const char *what, const char *plural);

#endif
