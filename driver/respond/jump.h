/** Criterion for a jump of the motion: the standard deviations of the transmission errors of two neighbouring motions. */
#pragma once

#include "files/response.h"

#include <stdbool.h>

/** Number of times that the interval between two values is halved. */
enum { JUMP_HALVINGS = 10 };
/** Part of a difference that must remain then. A motion that changes smoothly has 0.001 of it, a square-root
 *  bifurcation 0.03. */
#define JUMP_STAYS 0.5

/** Largest relative difference of a metric over the meshes, relative to the larger value. @param row  the metric */
double jump_size(const model_output *row, const response_point *a, const response_point *b);
/** Whether to refine the interval between two values. */
bool jump_is_likely(const model_output *row, const response_point *a, const response_point *b);
