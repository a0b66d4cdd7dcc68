/** Outputs at the nodes of a quadrature in a part of a step, and the polynomial through them. */
#pragma once

#include "base/memory.h"
#include "integrate/integrate_types.h"
#include "model/model.h"

enum { STEP_NODES_MOST = 8 };

typedef struct {
    const model *model;
    int n;                       /**< nodes */
    bool *wanted;                /**< [outputs] */
    double *y;                   /**< [n * states] */
    double *values;              /**< [n * n_values] at the nodes; those that are not wanted do not change */
    double t[STEP_NODES_MOST];   /**< the nodes [s] */
    double weight[STEP_NODES_MOST]; /**< of an integral over time [s] */
    int n_samples;
    double *samples; /**< [n_samples * n] from values at the nodes to those at evenly spaced places, the ends among them */
} step_nodes;

/** Ask for nothing yet. @param pool  in which the arrays last */
void step_nodes_init(step_nodes *nodes, const model *model, memory_pool *pool);
/** Ask for an output. @return whether the model has it */
bool step_nodes_want(step_nodes *nodes, const char *output);

/** Part of a wave that may lie in the part of a step that is looked at: then its integral is right to 1e-9. */
double step_nodes_reach(const step_nodes *nodes);
/** Find what is wanted between two times in a step. @return false if it is not known there */
bool step_nodes_look(step_nodes *nodes, const integrate_step *step, double from, double to);
/** Largest value there of a quantity, by the polynomial through its values at the nodes [n].
 *  @param sense  1, or -1 for the smallest
 *  @param beyond what matters is only above that, in the sense */
double step_nodes_peak(const step_nodes *nodes, const double *values, int sense, double beyond);
