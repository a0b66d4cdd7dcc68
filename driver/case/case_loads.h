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

/** The numbers of a block as its kind, one of the table, lists them; whether they go together is the model's to say.
 *  @return false with the reason in the checker's error */
bool case_resolve_kind(checker *checker, const case_node *block, int n_kinds, const kind_info *kinds,
                       kind_choice *choice);

/** Fill the wheel's loads from its list of blocks. @return false with the reason in the checker's error */
bool case_resolve_loads(checker *checker, const case_node *list, const law_tables *laws, wheel_description *wheel);

#endif
