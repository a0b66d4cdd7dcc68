/** The maximum of a smooth function in a bracket, by parabolas. Knows nothing of what the function is. */
#pragma once

/** The function at t; NaN where it is not known, which ends the search. */
typedef double (*peak_function)(void *with, double t);

typedef struct {
    double left, right; /**< the same: there is nothing to climb */
    double start;       /**< where to begin; the search ends if the first parabola leads lower from there */
    double width;       /**< of the first parabola */
    double expected;    /**< about what the function is at the start; NaN if that is not known */
    double wanted;      /**< a peak that stays below this need not be found */
} peak_bracket;

/** Ask the function at the start and at places that come nearer to its maximum: the caller keeps the largest value. */
void peak_climb(peak_function function, void *with, const peak_bracket *bracket);

/** Where the parabola through three points has its maximum; NaN if it has none. */
double peak_of_parabola(const double t[3], const double f[3]);
