/** Outputs requested of a simulation. */
#pragma once

#include "base/memory.h"
#include "integrate/integrate_types.h"
#include "model/model.h"

#include <stddef.h>

typedef struct {
    const model *model;
    int n;        /**< their number */
    int *outputs; /**< [n] their indices */
    int *offsets; /**< [n_outputs] number of values before those of each output, -1 if not requested */
    int n_values; /**< number of all requested values */
} requested_outputs;

/** Initialise without requested outputs. @param arena  owns the arrays */
void requested_outputs_init(requested_outputs *requested, const model *model, memory_arena *arena);
/** Request an output. @return the index of its first value; -1 if the model does not have it */
int requested_outputs_add(requested_outputs *requested, const char *name);

/** Whether an output is requested. @param index  among the model's outputs */
bool requested_outputs_has(const requested_outputs *requested, int index);

/** Values at up to DAE_LANES times of one discrete state. */
typedef struct {
    int n; /**< number of times */
    const double *t,
        *values; /**< t: [n]; value `index` at time k is values[index * DAE_LANES + k]; elements behind n are
                  *   repetitions or zeros */
    const output_mark *marks; /**< [n] for outputs by position; NULL for outputs by time */
} output_block;

/** A value at all times of a block. @return [DAE_LANES] */
static inline const double *output_values(const output_block *block, int index)
{
    return block->values + (size_t)index * DAE_LANES;
}
