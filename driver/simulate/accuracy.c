#include "simulate/accuracy.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* Errors of the penetration as a function of the tolerance, the largest found by `python benchmarks/stated_accuracy.py
 * --measure`: factor * tolerance^power. Radau controls its steps by tolerance^(4/7), and its errors follow. The law of
 * ida excludes gears that lose contact repeatedly. */
typedef struct {
    double factor, power;
} error_law;

static const error_law radau = {1.4e-3, 4.0 / 7}, ida = {10.0, 5.0 / 6};
static const double largest_tolerance = 1e-3; /* that a case may specify */

double accuracy_tolerance(double accuracy, integrator_kind integrator)
{
    const error_law *law = integrator == INTEGRATOR_RADAU ? &radau : &ida;
    char digits[16]; /* two significant digits: the same on every machine, independent of its pow() */
    (void)snprintf(digits, sizeof digits, "%.1e", pow(accuracy / law->factor, 1 / law->power));
    return fmin(strtod(digits, NULL), largest_tolerance);
}
