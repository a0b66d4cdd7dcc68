#include "simulate/accuracy.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* Errors of the penetration at a tolerance, the largest of those that `python benchmarks/stated_accuracy.py --measure` finds:
 * factor * tolerance^power. Radau controls its steps by tolerance^(4/7), and so its errors go. That of ida is not of gears that
 * lose contact again and again. */
typedef struct {
    double factor, power;
} error_law;

static const error_law radau = {1.4e-3, 4.0 / 7}, ida = {10.0, 5.0 / 6};
static const double largest_tolerance = 1e-3; /* that a case may state */

double accuracy_tolerance(double accuracy, integrator_kind integrator)
{
    const error_law *law = integrator == INTEGRATOR_RADAU ? &radau : &ida;
    char digits[16]; /* two: the same on every machine, whatever its pow() */
    (void)snprintf(digits, sizeof digits, "%.1e", pow(accuracy / law->factor, 1 / law->power));
    return fmin(strtod(digits, NULL), largest_tolerance);
}
