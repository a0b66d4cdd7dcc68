/** Largest and least root stress of each wheel over a window. The nodes of a part of a step show whether it may contain
 *  an extreme; then the stress is evaluated at both ends of the part and at states between the nodes, because the
 *  largest stress of all teeth has kinks where another tooth takes over. */
#pragma once

#include "simulate/step_nodes.h"

typedef struct {
    double high, low; /**< [Pa] */
} root_extremes;

typedef struct {
    int n_wheels;        /**< 0: not requested, or the model does not have these outputs */
    int high_at, low_at; /**< indices of their first values at the nodes */
    const model *model;
    model_sampler *sampler;        /**< of both outputs at one state */
    double *y, *values;            /**< of one state */
    root_extremes *period, *total; /**< [n_wheels] */
} root_metrics;

/** Request the outputs at the nodes. @param arena  owns the arrays */
void root_metrics_init(root_metrics *roots, const model *model, bool is_requested, step_nodes *nodes,
                       memory_arena *arena);
void root_metrics_clear(root_metrics *roots);
void root_metrics_serialize(root_metrics *roots, archive *archive);
/** Add the part of a step whose nodes were evaluated. */
void root_metrics_add(root_metrics *roots, const step_nodes *nodes, const integrate_step *step, double from, double to);
/** Add the present period to the total. */
void root_metrics_complete(root_metrics *roots);
/** Extremes of a wheel; NaN if there are none. */
root_extremes root_metrics_of(const root_metrics *roots, int wheel);
