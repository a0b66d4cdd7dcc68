/** Outputs at the nodes of a quadrature in a part of a step, and the polynomial through them. */
#pragma once

#include "base/memory.h"
#include "integrate/integrate_types.h"
#include "model/model.h"

#include <stddef.h>

enum { STEP_NODES_MOST = 8, STEP_NODES_SAMPLES = 4 * STEP_NODES_MOST + 1 };

typedef struct {
    const model *model;
    int n;                          /**< nodes */
    int n_wanted, *wanted;          /**< indices of outputs */
    int *before;                    /**< [n_wanted] values before those of each */
    int n_values;                   /**< of all of them */
    model_sampler *sampler;         /**< made at the first look */
    double *y;                      /**< [states * n] each state at the nodes side by side */
    double *one;                    /**< [states] at a node */
    double *values;                 /**< [n_values * n] each value at the nodes side by side */
    double t[STEP_NODES_MOST];      /**< the nodes [s] */
    double weight[STEP_NODES_MOST]; /**< of an integral over time [s]; 0 where no node is */
} step_nodes;

/** Ask for nothing yet. @param pool  in which the arrays last */
void step_nodes_init(step_nodes *nodes, const model *model, memory_pool *pool);
void step_nodes_clear(step_nodes *nodes);
/** Ask for an output, before the first look. @return index of its first value; -1 if the model does not have it */
int step_nodes_want(step_nodes *nodes, const char *output);
/** A value at the nodes [n]. */
static inline const double *step_nodes_value(const step_nodes *nodes, int index)
{
    return nodes->values + (size_t)index * (size_t)nodes->n;
}

/** Part of a wave that may lie in the part of a step that is looked at: then its integral is right to 1e-9. */
double step_nodes_reach(const step_nodes *nodes);
/** Value at the end, by the same polynomial. */
double step_nodes_end(const step_nodes *nodes, const double *values);
/** Find what is wanted between two times in a step. @return false if it is not known there */
bool step_nodes_look(step_nodes *nodes, const integrate_step *step, double from, double to);
/** Bounds of what a quantity may come to in the part of a step, by its values at the nodes [n]: no more than half of their range
 *  hides between them or behind the last. */
typedef struct {
    double may_reach, may_fall;
} node_range;
static inline node_range step_nodes_range(const step_nodes *nodes, const double *values)
{
    enum { HALF = STEP_NODES_MOST / 2 };
    const bool whole = nodes->n == STEP_NODES_MOST;
    double highest = values[0], lowest = values[0];
    for (int k = whole ? HALF : 1; k < nodes->n; k++) { /* fmax is a call; two by two, for they wait for each other */
        const double other = values[whole ? k - HALF : 0];
        const double high = values[k] > other ? values[k] : other, low = values[k] < other ? values[k] : other;
        highest = high > highest ? high : highest;
        lowest = low < lowest ? low : lowest;
    }
    const double hidden = 0.5 * (highest - lowest);
    return (node_range){highest + hidden, lowest - hidden};
}
/** Largest value there of a quantity, by the polynomial through its values at the nodes [n].
 *  @param sense  1, or -1 for minus the smallest */
double step_nodes_peak(const step_nodes *nodes, const double *values, int sense);
