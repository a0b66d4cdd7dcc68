/** The points of branches with their numbers, what did not become one, and what is on a branch already. */
#pragma once

#include "respond/branches.h"

/** Tell the points that the last branch has gained, and keep what the kernel needs of them. @param n  that it has now */
void branches_take_points(branches *branches, int n);
/** Remember that something did not come to an orbit. */
void branches_note(branches *branches, double value, const char *why);
/** The numbers of the present orbit. @return NULL if a run leaves it */
double *branches_numbers(branches *branches, const model_orbit *orbit);
/** Whether a branch passes an orbit that has these numbers. */
bool branches_pass(branches *branches, double value, int periods, const double *values);
/** Whether a branch of twice the period begins or ends at a doubling. */
bool branches_have_entered(const branches *branches, const model_orbit *doubling);
/** How many of the values that are asked for a branch passes with stable orbits and has none at. @param first  of these values */
int branches_left_out(const branches *branches, int branch, double *first);
