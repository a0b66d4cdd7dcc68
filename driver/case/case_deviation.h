/** From the keys of a wheel's flank deviations to its description. */
#ifndef EVOLVENT_CASE_DEVIATION_H
#define EVOLVENT_CASE_DEVIATION_H

#include "case/case_check.h"
#include "case/description.h"

/** Fill the deviations of a wheel from its block.
 *  @return false with the fault written down, if a relief has not exactly one start */
bool case_resolve_deviation(checker *checker, const case_node *wheel, deviation_description *deviation);

#endif
