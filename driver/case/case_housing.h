/** The housing and gravity from the checked tree. */
#ifndef EVOLVENT_CASE_HOUSING_H
#define EVOLVENT_CASE_HOUSING_H

#include "case/case_check.h"
#include "case/description.h"

/** Fill description->gravity and description->housing. @return false with the reason in the checker's error */
bool case_resolve_housing(checker *checker, const case_node *root, description *description);

#endif
