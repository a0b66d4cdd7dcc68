/** The loads of a wheel from the checked tree. */
#ifndef EVOLVENT_CASE_LOADS_H
#define EVOLVENT_CASE_LOADS_H

#include "case/case_check.h"
#include "case/description.h"

typedef struct {
    int n;
    double *time, *values; /**< [n], the caller's to free, also after a refusal */
} case_table;

/** A table from its keys `time` and `key`. @return false with the reason in the checker's error */
bool case_resolve_table(checker *checker, const case_node *block, const char *key, case_table *table);

/** Fill the wheel's loads from its list of blocks. @return false with the reason in the checker's error */
bool case_resolve_loads(checker *checker, const case_node *list, wheel_description *wheel);

#endif
