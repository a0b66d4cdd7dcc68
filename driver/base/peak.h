/** Maximum of a smooth function in a bracket, by successive parabolas. Independent of the function. */
#pragma once

/** The function at t; NaN where it is undefined, which ends the search. */
typedef double (*peak_function)(void *with, double t);

typedef struct {
    double left, right; /**< if equal, there is nothing to search */
    double start;       /**< first abscissa; the search ends if the first parabola leads to a lower value from there */
    double width;       /**< of the first parabola */
    double expected;    /**< approximate value at the start; NaN if unknown */
    double threshold;   /**< a peak below this value need not be found */
} peak_bracket;

/** Evaluate the function at the start and at abscissae that approach its maximum; the caller records the largest value. */
void peak_climb(peak_function function, void *with, const peak_bracket *bracket);

/** Abscissa of the maximum of the parabola through three points; NaN if it has none. */
double peak_of_parabola(const double t[3], const double f[3]);
