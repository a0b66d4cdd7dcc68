#include "respond/jump.h"

#include <math.h>

static const double small = 0.05; /* differences that are no jump worth the name */

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
    const bool both_are_known = a->period >= 0 && b->period >= 0; /* what still settles is on no motion yet */
    return either_repeats && both_are_known && jump_size(row, a, b) > small;
}
