/** The keys of a case file that do not depend on the laws, loads and supports of the model. */
#ifndef EVOLVENT_CASE_KEYS_H
#define EVOLVENT_CASE_KEYS_H

#include "case/case_schema.h"

/** Those of a block stand together, the one that selects the variant first. */
extern const case_key case_keys[];
extern const int n_case_keys;

#endif
