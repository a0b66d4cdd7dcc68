/** A store of wheels with compliance in which the first wheel stands for all, so that no time is lost with finite elements. Its numbers
 *  are scaled by a hash of the wheel's key: wheels of other keys differ. */
#ifndef EVOLVENT_TESTS_WHEEL_STAND_IN_H
#define EVOLVENT_TESTS_WHEEL_STAND_IN_H

#include <evolvent/kernel.h>

typedef struct {
    int n;
    double *numbers; /* [n] of the first wheel, over its scale; NULL: no wheel yet */
} wheel_stand_in;

evl_wheel_store wheel_stand_in_store(wheel_stand_in *wheel);
void wheel_stand_in_free(wheel_stand_in *wheel);

#endif
