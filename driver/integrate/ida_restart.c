#include "integrate/ida_restart.h"

#include <ida/ida.h>
#include <math.h>

/* The error that a first step is to have, over what IDA accepts: events differ, a failure costs more than two doublings, and what the
 * steps of order 1 err by stands in the differences from which the next orders begin. */
static const double wanted = 0.0625;
static const double of_correction = 0.5; /* of a prediction by order 1 is IDA's estimate of the error */

ida_restart ida_restart_create(void)
{
    return (ida_restart){.could = INFINITY};
}

void ida_restart_note(ida_restart *restart, void *ida, N_Vector weights, N_Vector errors)
{
    long steps = 0;
    double step = 0;
    if (IDAGetNumSteps(ida, &steps) != IDA_SUCCESS || steps != 1 || IDAGetLastStep(ida, &step) != IDA_SUCCESS ||
        IDAGetEstLocalErrors(ida, errors) != IDA_SUCCESS) {
        return;
    }
    const double error = of_correction * N_VWrmsNorm(errors, weights);
    restart->could = error > 0 ? step * sqrt(wanted / error) : INFINITY;
}

double ida_restart_step(const ida_restart *restart, double longest)
{
    return fmin(restart->could, longest);
}
