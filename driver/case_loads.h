/** The loads of a wheel from the checked tree. */
#ifndef EVOLVENT_CASE_LOADS_H
#define EVOLVENT_CASE_LOADS_H

#include "case_check.h"
#include "description.h"

/** Fill the wheel's loads from its list of blocks. @return false with the reason in the checker's error */
bool case_resolve_loads(checker *checker, const case_node *list, wheel_description *wheel);

#endif
