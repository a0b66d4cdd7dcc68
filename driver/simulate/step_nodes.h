/** Outputs at the nodes of a quadrature in a part of a step, and the polynomial through them. */
#pragma once

#include "base/memory.h"
#include "integrate/integrate_types.h"
#include "model/model.h"

#include <stddef.h>

enum { STEP_NODES_MOST = 8 };

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
    double weight[STEP_NODES_MOST]; /**< of an integral over time [s] */
    int n_samples;
    double
        *samples; /**< [n_samples * n] from values at the nodes to those at evenly spaced places, the ends among them */
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
/** Largest value there of a quantity, by the polynomial through its values at the nodes [n].
 *  @param sense  1, or -1 for the smallest
 *  @param beyond what matters is only above that, in the sense */
double step_nodes_peak(const step_nodes *nodes, const double *values, int sense, double beyond);
