/** The entries of a case by their paths, as --set takes them. */
#ifndef EVOLVENT_TESTS_CASE_ENTRIES_AT_H
#define EVOLVENT_TESTS_CASE_ENTRIES_AT_H

#include "case/case.h"

/** The entry of a path such as "wheels.pinion.loads.0.value"; NULL if the case does not give it. */
const evl_entry *entry_at(const case_file *file, const char *path);
/** Its first number; NaN without one. */
double number_at(const case_file *file, const char *path);
/** Its name or word; "" without one. */
const char *word_at(const case_file *file, const char *path);
/** Two cases say the same to the model. */
void assert_same_entries(const case_file *one, const case_file *other);

#endif
