/** Branches of periodic orbits: from settled motions of a gearbox along the parameter, through folds, and onwards from
 *  period doublings. */
#pragma once

#include "respond/branches_points.h"

/** Whether all branches are complete. */
bool branches_are_done(const branches *branches);
/** Do the next task: search a settled motion, start a branch, or find its next point.
 *  @return ORBIT_FAILED with the reason in `error`; then, and after an interrupt, the task remains to be done */
orbit_end branches_step(branches *branches, evl_error *error);
/** Serialise all that a later step needs. */
void branches_serialize(branches *branches, archive *archive);
/** Restore the serialised data in the kernel. @return false with the reason in `error` */
bool branches_resume(branches *branches, evl_error *error);
void branches_free(branches *branches);
