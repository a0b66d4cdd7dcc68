/** Largest or least values of outputs over a window, element by element. The nodes of a part of a step show whether it
 *  may contain an extreme; then the outputs are evaluated at both ends of the part and at states between the nodes,
 *  because outputs may have kinks, such as the largest stress of all teeth where another tooth takes over. */
#pragma once

#include "simulate/step_nodes.h"

enum { EXTREMES_MOST_OUTPUTS = 2 };

typedef struct {
    const char *output;
    int sense; /**< 1: largest value, -1: least value */
} sought_extreme;

typedef struct {
    int n; /**< elements of each output; 0: not requested, or the model does not have these outputs */
    int n_outputs;
    int sense[EXTREMES_MOST_OUTPUTS];
    int first_at[EXTREMES_MOST_OUTPUTS]; /**< indices of their first values at the nodes */
    const model *model;
    model_sampler *sampler; /**< of all outputs at one state */
    double *y, *values;     /**< of one state; values [n_outputs * n] */
    double *period, *total; /**< extremes [n_outputs * n], multiplied by the sense; -INFINITY: none */
} output_extremes;

/** Request outputs with the same elements at the nodes. @param sought  [n_outputs] @param arena  owns the arrays */
void output_extremes_init(output_extremes *extremes, const model *model, int n_outputs, const sought_extreme *sought,
                          bool is_requested, step_nodes *nodes, memory_arena *arena);
void output_extremes_clear(output_extremes *extremes);
void output_extremes_serialize(output_extremes *extremes, archive *archive);
/** Add the part of a step whose nodes were evaluated. */
void output_extremes_add(output_extremes *extremes, const step_nodes *nodes, const integrate_step *step, double from,
                         double to);
/** Add the present period to the total. */
void output_extremes_complete(output_extremes *extremes);
/** Extreme of an element, from the index of the output; NaN if there is none. Undefined values (NaN) do not count. */
double output_extremes_of(const output_extremes *extremes, int output, int element);
