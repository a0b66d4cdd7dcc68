/** Points of branches with their metrics, failed attempts, and tests whether an orbit is already on a branch. */
#pragma once

#include "respond/branches.h"

/** Process the new points of the last branch, and store the kernel's data of them. @param n  its present number of
 *  points */
void branches_take_points(branches *branches, int n);
/** Record an attempt that did not converge to an orbit. */
void branches_note(branches *branches, double value, const char *why);
/** Metrics of the present orbit. @return NULL if a run departs from it */
double *branches_numbers(branches *branches, const model_orbit *orbit);
/** Whether a branch passes through an orbit with these metrics. */
bool branches_pass(branches *branches, double value, int periods, const double *values);
/** Whether a period-doubled branch starts or ends at a doubling. */
bool branches_have_entered(const branches *branches, const model_orbit *doubling);
/** Number of requested values that stable orbits of a branch pass without a point. @param first  the first of these
 *  values */
int branches_left_out(const branches *branches, int branch, double *first);
