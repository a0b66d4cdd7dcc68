/** Outputs at the nodes of a quadrature over a part of a step, and their interpolation polynomial. */
#pragma once

#include "base/memory.h"
#include "integrate/integrate_types.h"
#include "model/model.h"

#include <stddef.h>

enum { STEP_NODES_MOST = 8, STEP_NODES_SAMPLES = 4 * STEP_NODES_MOST + 1 };

typedef struct {
    const model *model;
    int n;                          /**< number of nodes */
    int n_requested, *requested;    /**< indices of outputs */
    int *before;                    /**< [n_requested] number of values before those of each */
    int n_values;                   /**< number of all values */
    model_sampler *sampler;         /**< created at first use */
    double *y;                      /**< [states * n] for each state variable the values at the nodes */
    double *one;                    /**< [states] at one node */
    double *values;                 /**< [n_values * n] for each value the values at the nodes */
    double t[STEP_NODES_MOST];      /**< times of the nodes [s] */
    double weight[STEP_NODES_MOST]; /**< quadrature weights over time [s]; 0 in unused elements */
} step_nodes;

/** Initialise without requested outputs. @param arena  owns the arrays */
void step_nodes_init(step_nodes *nodes, const model *model, memory_arena *arena);
void step_nodes_clear(step_nodes *nodes);
/** Request an output, before the first evaluation. @return index of its first value; -1 if the model does not have it */
int step_nodes_want(step_nodes *nodes, const char *output);
/** A value at the nodes [n]. */
static inline const double *step_nodes_value(const step_nodes *nodes, int index)
{
    return nodes->values + (size_t)index * (size_t)nodes->n;
}

/** Largest fraction of a wave in a part of a step for which its integral is accurate to 1e-9. */
double step_nodes_reach(const step_nodes *nodes);
/** Value at the end of the part, by the same polynomial. */
double step_nodes_end(const step_nodes *nodes, const double *values);
/** Evaluate the requested outputs between two times in a step. @return false if they are not available there */
bool step_nodes_look(step_nodes *nodes, const integrate_step *step, double from, double to);
/** Bounds of a quantity in the part of the step, from its values at the nodes [n]: between and behind the nodes it
 *  exceeds their range by at most half of that range. */
typedef struct {
    double may_reach, may_fall;
} node_range;
static inline node_range step_nodes_range(const step_nodes *nodes, const double *values)
{
    enum { HALF = STEP_NODES_MOST / 2 };
    const bool whole = nodes->n == STEP_NODES_MOST;
    double highest = values[0], lowest = values[0];
    for (int k = whole ? HALF : 1; k < nodes->n; k++) { /* fmax is a function call; in pairs, to shorten the dependency
                                                         * chain */
        const double other = values[whole ? k - HALF : 0];
        const double high = values[k] > other ? values[k] : other, low = values[k] < other ? values[k] : other;
        highest = high > highest ? high : highest;
        lowest = low < lowest ? low : lowest;
    }
    const double hidden = 0.5 * (highest - lowest);
    return (node_range){highest + hidden, lowest - hidden};
}
/** Largest value of a quantity in the part of the step, by the polynomial through its values at the nodes [n].
 *  @param sense  1, or -1 for minus the smallest */
double step_nodes_peak(const step_nodes *nodes, const double *values, int sense);
