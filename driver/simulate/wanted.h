/** The outputs that a simulation finds: those that somebody wants. */
#pragma once

#include "base/memory.h"
#include "integrate/integrate_types.h"
#include "model/model.h"

#include <stddef.h>

typedef struct {
    const model *model;
    int n;        /**< how many */
    int *outputs; /**< [n] their indices */
    int *places;  /**< [n_outputs] before the values of each output, -1 where nobody wants it */
    int n_values; /**< of all that are found */
} wanted_outputs;

/** Nobody wants anything yet. @param pool  in which the arrays last */
void wanted_init(wanted_outputs *wanted, const model *model, memory_pool *pool);
/** Want an output. @return the place of its first value; -1 if the model does not have it */
int wanted_add(wanted_outputs *wanted, const char *name);

/** Whether somebody wants an output. @param index  of the model's */
bool wanted_has(const wanted_outputs *wanted, int index);

/** Values at up to DAE_LANES times of one discrete state. */
typedef struct {
    int n; /**< times */
    const double *t,
        *values; /**< t: [n]; value `place` at time k is values[place * DAE_LANES + k]; behind the n there are others
                                 once more, or zeros */
    const output_mark *marks; /**< [n] of outputs by position; NULL by time */
} output_block;

/** A value at all times of a block. @return [DAE_LANES] */
static inline const double *output_values(const output_block *block, int place)
{
    return block->values + (size_t)place * DAE_LANES;
}
