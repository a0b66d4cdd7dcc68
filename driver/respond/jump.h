/** When a motion counts as having jumped: by the standard deviations of the transmission errors of two motions side by side. */
#pragma once

#include "files/response.h"

#include <stdbool.h>

/** How often what lies between two values is halved. */
enum { JUMP_HALVINGS = 10 };
/** The part of a difference that has to be left then. A motion that changes steadily has 0.001 of it, one that forks like a square root
 *  0.03. */
#define JUMP_STAYS 0.5

/** Largest difference of a number of a mesh, over the larger of both. @param row  which number */
double jump_size(const model_output *row, const response_point *a, const response_point *b);
/** Whether it is worth looking between two values. */
bool jump_is_likely(const model_output *row, const response_point *a, const response_point *b);
