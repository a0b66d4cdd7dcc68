#include "respond/jump.h"

#include <math.h>

static const double small = 0.05; /* differences below it are not regarded as a jump */

double jump_size(const model_output *row, const response_point *a, const response_point *b)
{
    double size = 0;
    for (int i = row->offset; i < row->offset + row->count; i++) {
        const double larger = fmax(fabs(a->values[i]), fabs(b->values[i]));
        size = larger > 0 ? fmax(size, fabs(a->values[i] - b->values[i]) / larger) : size;
    }
    return size;
}

bool jump_is_likely(const model_output *row, const response_point *a, const response_point *b)
{
    const bool either_repeats = a->period > 0 || b->period > 0;
    const bool both_are_known = a->period >= 0 && b->period >= 0; /* a motion that is not settled is not assigned to any
                                                                   * branch yet */
    return either_repeats && both_are_known && jump_size(row, a, b) > small;
}
